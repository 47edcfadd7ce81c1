"""Exports sentences as vectors for `l4d import`: once, on a machine that has the models.

    pip install numpy open_clip_torch
    python docs/import/export_text_embeddings.py --model clip --queries benchmark/queries --out clip.npz

    pip install numpy sentence-transformers
    python docs/import/export_text_embeddings.py --model e5 --queries benchmark/queries --out e5.npz

`clip` is OpenCLIP ViT-B-16 of laion2b_s34b_b88k, as LangSplat and 4D LangSplat compare with, and brings the four
phrases that every sentence is held against. `e5` is intfloat/e5-mistral-7b-instruct with the prompt
`summarization_query`, as 4D LangSplat gates time with; it has no phrases. Vectors are float32 of length 1.

`--queries` takes files or folders: `.jsonl` of queries (their field `text`) or text with one sentence a line.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import numpy as np

CLIP = ("ViT-B-16", "laion2b_s34b_b88k")
E5 = "intfloat/e5-mistral-7b-instruct"
PHRASES = ("object", "things", "stuff", "texture")


def main() -> None:
    """Reads sentences, asks the model and writes one archive."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--model", choices=["clip", "e5"], required=True)
    parser.add_argument("--queries", type=Path, nargs="+", required=True)
    parser.add_argument("--phrases", nargs="+", default=PHRASES, help="what sentences are compared with (clip)")
    parser.add_argument("--device", default=None, help="cpu or cuda; default: cuda if there is one")
    parser.add_argument("--out", type=Path, required=True)
    options = parser.parse_args()
    queries = sentences(options.queries)
    if not queries:
        parser.error("the queries hold no sentence")
    encode = clip if options.model == "clip" else e5
    arrays, name = encode(queries, options)
    np.savez(options.out, queries=np.array(queries), model=np.array([name]), **arrays)
    print(f"{options.out}: {len(queries)} sentences of {arrays['positives'].shape[1]} numbers, {name}")


def sentences(paths: list[Path]) -> list[str]:
    """All sentences, each once, in the order of the files."""
    found: dict[str, None] = {}
    for path in paths:
        files = sorted(path.glob("*.jsonl")) if path.is_dir() else [path]
        for file in files:
            lines = [line.strip() for line in file.read_text(encoding="utf-8").splitlines()]
            for line in filter(None, lines):
                found[json.loads(line)["text"] if file.suffix == ".jsonl" else line] = None
    return list(found)


def clip(queries: list[str], options: argparse.Namespace) -> tuple[dict[str, np.ndarray], str]:
    """Sentences and phrases as OpenCLIP sees them."""
    import open_clip
    import torch

    device = options.device or ("cuda" if torch.cuda.is_available() else "cpu")
    model, _, _ = open_clip.create_model_and_transforms(CLIP[0], pretrained=CLIP[1], device=device)
    tokenize = open_clip.get_tokenizer(CLIP[0])
    model.eval()

    def vectors(texts: list[str]) -> np.ndarray:
        with torch.inference_mode():
            parts = [model.encode_text(tokenize(texts[at : at + 256]).to(device)) for at in range(0, len(texts), 256)]
        return unit(torch.cat(parts).float().cpu().numpy())

    return {"positives": vectors(queries), "negatives": vectors(list(options.phrases))}, "/".join(CLIP)


def e5(queries: list[str], options: argparse.Namespace) -> tuple[dict[str, np.ndarray], str]:
    """Sentences as E5 sees them."""
    from sentence_transformers import SentenceTransformer

    model = SentenceTransformer(E5, device=options.device)
    model.max_seq_length = 4096
    vectors = model.encode(queries, prompt_name="summarization_query", convert_to_numpy=True)
    return {"positives": unit(np.asarray(vectors, dtype=np.float32))}, E5


def unit(vectors: np.ndarray) -> np.ndarray:
    """Vectors of length 1."""
    return (vectors / np.linalg.norm(vectors, axis=1, keepdims=True)).astype("<f4")


if __name__ == "__main__":
    main()
