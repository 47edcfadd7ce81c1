#!/usr/bin/env bash
# Makes the environment of the servers and a tiny model in the folder that is named; a finished one is left as it is.
set -euo pipefail
folder=${1:?usage: setup.sh FOLDER}
here=$(cd "$(dirname "$0")" && pwd)
mark="$folder/made-from"
wanted=$(cat "$here/requirements.txt" "$here/make_model.py" | sha256sum)
if [ -f "$mark" ] && [ "$(cat "$mark")" = "$wanted" ]; then
    exit 0
fi
python3.11 -m venv "$folder"
"$folder/bin/pip" install --quiet --requirement "$here/requirements.txt"
HF_HUB_OFFLINE=1 OMP_NUM_THREADS=1 "$folder/bin/python" "$here/make_model.py" "$folder/tiny"
echo "$wanted" > "$mark"
