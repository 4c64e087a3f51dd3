FROM python:3.12-slim AS build
WORKDIR /src
COPY . .
# Node.js for the page comes as a build dependency; exact versions come from the lock.
RUN pip wheel --no-cache-dir --no-deps --wheel-dir /wheels . \
    && sed -n 's/ \\$//; /^[a-z]/p' requirements.lock > /wheels/constraints.txt

FROM python:3.12-slim
COPY --from=build /wheels /wheels
RUN pip install --no-cache-dir --constraint /wheels/constraints.txt \
        "$(ls /wheels/*.whl)[dask,postgresql,mdf,oidc,parquet]" \
    && rm -r /wheels \
    && useradd --create-home --uid 10001 flexsid \
    && install -d -o flexsid -g flexsid /data
USER flexsid
VOLUME /data
ENV FLEXSID_DATABASE=sqlite:////data/flexsid.db \
    FLEXSID_PORT=8000 \
    OPENBLAS_NUM_THREADS=1
CMD ["flexsid", "serve"]
