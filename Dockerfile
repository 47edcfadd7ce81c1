# l4d without Rust or Python on the machine; docs/python.md says how to run it.
FROM rust:1.95-slim-bookworm AS build
RUN apt-get update \
    && apt-get install -y --no-install-recommends g++ python3 python3-pip python3-venv \
    && rm -rf /var/lib/apt/lists/*
WORKDIR /l4d
COPY . .
RUN pip wheel --no-deps --wheel-dir /wheels ./crates/l4d-py

FROM python:3.11-slim-bookworm
# What bpy loads (tests/packages.txt). tini hands signals on: the first process of a container gets none by default.
RUN apt-get update \
    && apt-get install -y --no-install-recommends \
       libx11-6 libxrender1 libxfixes3 libxi6 libxkbcommon0 libgl1 libvulkan1 mesa-vulkan-drivers tini \
    && rm -rf /var/lib/apt/lists/*
RUN --mount=type=bind,from=build,source=/wheels,target=/wheels \
    pip install --no-cache-dir /wheels/*.whl
# pip writes here while it makes the Blender environment, whichever user runs the container.
ENV HOME=/tmp
WORKDIR /l4d
ENTRYPOINT ["tini", "--", "l4d"]
CMD ["--help"]
