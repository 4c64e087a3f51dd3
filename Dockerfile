# A site may build on another image: --build-arg PYTHON_IMAGE=...
ARG PYTHON_IMAGE=python:3.12.14-slim@sha256:78387bc3881b8273120a12ebe6c1ab22b018ccc2c9adf565ae1ac9b536e184ea
FROM ${PYTHON_IMAGE} AS build
WORKDIR /src
COPY . .
# Node.js for the page comes as a build dependency. Every package has the exact version and the
# hash of the lock, the packages of the page those of package-lock.json.
RUN pip install --no-cache-dir --require-hashes -r deploy/uv.txt \
    && uv build --wheel --build-constraint requirements.lock --require-hashes --out-dir /wheels \
    && uv venv /opt/flexsid \
    && uv pip install --no-cache --compile-bytecode --python /opt/flexsid/bin/python --constraint requirements.lock \
        "flexsid[dask,postgresql,mdf,mqtt,nats,oidc,parquet,recordings] @ file://$(ls /wheels/*.whl)"

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
