# The base of agents' images: Python and the SDK, nothing else. `wildscav build` builds it when it is missing, with the
# SDK's wheel as its context; WILDSCAV_PYTHON_IMAGE selects another Python image than PYTHON below.
ARG PYTHON=docker.io/library/python:3.11-slim
FROM ${PYTHON}
COPY *.whl /wheels/
# A virtual environment, because some systems do not allow pip to install into their own Python.
RUN python3 -m venv /opt/agent && /opt/agent/bin/pip install --no-cache-dir --quiet /wheels/*.whl
ENV PATH=/opt/agent/bin:/usr/local/bin:/usr/bin:/bin LANG=C.UTF-8
WORKDIR /submission
USER 65534:65534
# The seat's address and token are environment variables; submission.toml names the entry point.
ENTRYPOINT ["python", "-m", "wildscav.sdk", "/submission"]
