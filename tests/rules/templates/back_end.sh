#!/usr/bin/env bash
# A back-end begins as a copy of the smallest one.
set -euo pipefail
cp -r backends/null backends/grey
cd backends/grey
mv null_backend.h grey_backend.h
mv null_backend.cpp grey_backend.cpp
sed -i 's/null_backend/grey_backend/g; s/NullBackend/GreyBackend/g; s/tessera_backend_null/tessera_backend_grey/
    s/null-1/grey-1/; s/{"null"/{"grey"/; s:backends/null:backends/grey:' ./*
