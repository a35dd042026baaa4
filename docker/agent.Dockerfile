# The image of one submission: its code and what its requirements.txt names. Made by `wildscav build DIR`; the
# context is the submission's folder. In a match there is no network: whatever is needed must be in here.
ARG BASE=localhost/wildscav/agent-base
FROM ${BASE}
USER 0:0
# Apart from the code, so that packages are installed again only when they change.
COPY submission.toml requirements.tx[t] /requirements/
RUN if [ -f /requirements/requirements.txt ]; then \
        pip install --no-cache-dir --quiet -r /requirements/requirements.txt; fi
COPY . /submission
USER 65534:65534
