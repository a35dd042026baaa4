# The image of one submission: its code and the packages in its requirements.txt. `wildscav build DIR` builds it; the
# context is the submission's folder. There is no network in a match, so the image must contain everything needed.
ARG BASE=localhost/wildscav/agent-base
FROM ${BASE}
USER 0:0
# Copied before the code, so that packages are installed again only when the requirements change.
COPY submission.toml requirements.tx[t] /requirements/
RUN if [ -f /requirements/requirements.txt ]; then \
        pip install --no-cache-dir --quiet -r /requirements/requirements.txt; fi
COPY . /submission
USER 65534:65534
