# The base of agents' images: Python and the SDK, nothing else. `wildscav build` makes it when it is missing, with
# the SDK's wheel as its context; WILDSCAV_PYTHON_IMAGE names another Python for it than that of PYTHON below.
ARG PYTHON=docker.io/library/python:3.11-slim
FROM ${PYTHON}
COPY *.whl /wheels/
# A virtual environment, since some systems' Python belongs to the system.
RUN python3 -m venv /opt/agent && /opt/agent/bin/pip install --no-cache-dir --quiet /wheels/*.whl
ENV PATH=/opt/agent/bin:/usr/local/bin:/usr/bin:/bin LANG=C.UTF-8
WORKDIR /submission
USER 65534:65534
# Address and token of the seat come as variables; the entry point stands in submission.toml.
ENTRYPOINT ["python", "-m", "wildscav.sdk", "/submission"]
