# Three stages: the first builds the page, the second compiles treestroke and sets up what it needs, the third runs it.
# Digests are those of the images' indexes, which hold all platforms; tag and digest change together.
FROM node:20.20.2-bookworm-slim@sha256:2cf067cfed83d5ea958367df9f966191a942351a2df77d6f0193e162b5febfc0 AS page
WORKDIR /build/frontend
COPY frontend/package.json frontend/package-lock.json frontend/.npmrc ./
RUN npm ci
COPY examples /build/examples
COPY frontend ./
RUN node_modules/.bin/vite build

FROM python:3.11.17-slim-bookworm@sha256:2333bd330d12de02514770b3585cad313644316047cdee24a7acfdece6de6efb AS build
RUN apt-get update \
    && apt-get install --yes --no-install-recommends gcc libc6-dev \
    && rm -rf /var/lib/apt/lists/*
WORKDIR /build
COPY requirements.txt requirements-dev.txt ./
RUN python -m venv /venv && /venv/bin/pip install --no-cache-dir --require-hashes -r requirements.txt
COPY pyproject.toml setup.py README.md LICENSE ./
COPY backend backend
COPY --from=page /build/backend/treestroke/api/page backend/treestroke/api/page
# setuptools, which builds it, is pinned like the rest. Without its compiled part growth would be slow: that ends the build.
RUN sed -n '/^setuptools==/,/[^\\]$/p' requirements-dev.txt > build.txt \
    && pip install --no-cache-dir --require-hashes -r build.txt \
    && pip wheel --no-cache-dir --no-deps --no-build-isolation --wheel-dir dist . \
    && /venv/bin/pip install --no-cache-dir --no-deps dist/*.whl \
    && /venv/bin/python -c "import treestroke.core.grow._engine, treestroke.core.leaf._covering"

FROM python:3.11.17-slim-bookworm@sha256:2333bd330d12de02514770b3585cad313644316047cdee24a7acfdece6de6efb
RUN useradd --system --uid 10001 --home-dir /data treestroke \
    && install --directory --owner treestroke --group treestroke /data
COPY --from=build /venv /venv
ENV PATH=/venv/bin:$PATH PYTHONUNBUFFERED=1 TREESTROKE_DATA=/data
USER treestroke
WORKDIR /data
VOLUME /data
HEALTHCHECK --interval=10s --timeout=5s --start-period=60s --retries=3 \
    CMD ["python", "-c", "import os, urllib.request as r; r.urlopen(f\"http://127.0.0.1:{os.environ.get('TREESTROKE_PORT') or 8000}/livez\", timeout=4)"]
# Without a database of its own the service listens on 127.0.0.1 only: run it with the host's network then.
CMD ["treestroke", "serve"]
