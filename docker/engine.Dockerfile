# The match server, the evaluator and a season's web site and conductor, as three targets; the context is the repository, in
# which `make viewer` has built what draws matches on the site:
#   docker build -f docker/engine.Dockerfile --target server -t wildscav/server .
#   docker build -f docker/engine.Dockerfile --target evaluator -t wildscav/evaluator .
#   docker build -f docker/engine.Dockerfile --target season -t wildscav/season .
ARG PYTHON=docker.io/library/python:3.11-slim
FROM ${PYTHON} AS source
COPY pyproject.toml hatch_build.py README.md LICENSE /source/
COPY engine /source/engine
COPY platform /source/platform
COPY evaluator /source/evaluator
COPY leaderboard /source/leaderboard
COPY submissions /source/submissions
COPY docker /source/docker
RUN python3 -m venv /opt/wildscav
ENV PATH=/opt/wildscav/bin:/usr/local/bin:/usr/bin:/bin LANG=C.UTF-8 WILDSCAV_CACHE_DIR=/var/cache/wildscav

FROM source AS server
RUN pip install --no-cache-dir --quiet '/source[server]'
RUN mkdir -p /var/cache/wildscav && chown 65534:65534 /var/cache/wildscav
USER 65534:65534
EXPOSE 50051-50055
ENTRYPOINT ["wildscav", "serve"]
CMD ["--listen", "0.0.0.0:50051", "--insecure", "--workers", "4", "--organizer-token-file", "/run/secrets/organizer_token", \
    "--log-format", "json"]

FROM source AS evaluator
# The sandbox of agents is bubblewrap, because a container in a container would need its own container engine. It is
# set here, so that evaluations fail where bubblewrap does not work, instead of using another sandbox.
ENV WILDSCAV_SANDBOX=bubblewrap
RUN apt-get update -qq && apt-get install -qq -y --no-install-recommends bubblewrap libseccomp2 util-linux \
    && rm -rf /var/lib/apt/lists/*
RUN pip install --no-cache-dir --quiet '/source[evaluator,leaderboard]'
WORKDIR /work
ENTRYPOINT ["wildscav"]
CMD ["--help"]

FROM evaluator AS season
RUN test -f /source/platform/wildscav_stage/static/viewer/viewer.js \
    || { echo 'The viewer of matches is not built: run make viewer in the checkout, then build this image again.' >&2; exit 1; }
RUN pip install --no-cache-dir --quiet '/source[postgresql]'
WORKDIR /srv
CMD ["season", "--help"]
