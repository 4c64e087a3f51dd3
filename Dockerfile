# A site may pin the image: --build-arg PYTHON_IMAGE=python@sha256:...
ARG PYTHON_IMAGE=python:3.12-slim
FROM ${PYTHON_IMAGE} AS build
WORKDIR /src
COPY . .
# Node.js for the page comes as a build dependency. Every package has the exact version and the
# hash of the lock, the packages of the page those of package-lock.json.
RUN pip install --no-cache-dir uv==0.13.8 \
    && uv build --wheel --build-constraint requirements.lock --require-hashes --out-dir /wheels \
    && uv venv /opt/flexsid \
    && uv pip install --no-cache --compile-bytecode --python /opt/flexsid/bin/python --constraint requirements.lock \
        "flexsid[dask,postgresql,mdf,oidc,parquet] @ file://$(ls /wheels/*.whl)"

FROM ${PYTHON_IMAGE}
COPY --from=build /opt/flexsid /opt/flexsid
RUN useradd --create-home --uid 10001 flexsid \
    && install -d -o flexsid /data /certificates /backups
USER flexsid
VOLUME /data
ENV PATH=/opt/flexsid/bin:$PATH \
    FLEXSID_DATABASE=sqlite:////data/flexsid.db \
    FLEXSID_PORT=8000 \
    OPENBLAS_NUM_THREADS=1 \
    PYTHONDONTWRITEBYTECODE=1
CMD ["flexsid", "serve"]
