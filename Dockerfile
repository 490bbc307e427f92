# Build:  docker build -t lpv-oed .
# Run:    docker run --init --read-only --tmpfs /tmp -p 127.0.0.1:8000:8000 -e LPV_OED_TOKEN=... -v lpv-oed-data:/data lpv-oed
# A server that listens beyond loopback, as this one must, refuses to start without a token.

FROM debian:bookworm-slim AS build
RUN apt-get update \
    && apt-get install -y --no-install-recommends python3 python3-venv \
    && rm -rf /var/lib/apt/lists/*
RUN python3 -m venv /opt/lpv-oed
WORKDIR /src
COPY pyproject.toml constraints.txt README.md LICENSE ./
COPY identification identification
COPY oed oed
COPY app app
RUN /opt/lpv-oed/bin/pip install --no-cache-dir --constraint constraints.txt '.[postgresql]' \
    && /opt/lpv-oed/bin/pip uninstall --yes pip setuptools

FROM debian:bookworm-slim
RUN apt-get update \
    && apt-get install -y --no-install-recommends python3 \
    && rm -rf /var/lib/apt/lists/* \
    && useradd --uid 10001 --create-home --shell /usr/sbin/nologin lpv-oed \
    && install -d -o lpv-oed -g lpv-oed /data
COPY --from=build /opt/lpv-oed /opt/lpv-oed
ENV PATH=/opt/lpv-oed/bin:$PATH \
    PYTHONUNBUFFERED=1 \
    PYTHONDONTWRITEBYTECODE=1 \
    LPV_OED_DATA_DIR=/data \
    LPV_OED_HOST=0.0.0.0 \
    LPV_OED_PORT=8000
USER lpv-oed
WORKDIR /data
VOLUME ["/data"]
EXPOSE 8000
HEALTHCHECK --interval=30s --timeout=5s --start-period=20s --retries=3 \
    CMD ["python3", "-c", "import os, urllib.request as r; r.urlopen('http://127.0.0.1:' + os.environ['LPV_OED_PORT'] + '/v1/health', timeout=4)"]
CMD ["lpv-oed", "serve"]
