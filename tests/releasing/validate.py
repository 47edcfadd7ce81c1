"""Validates a release folder with tools that others wrote: mlcroissant, datasets, huggingface_hub, cffconvert.

pip install mlcroissant datasets huggingface_hub cffconvert
"""

import json
import logging
import subprocess
import sys
from pathlib import Path


def check_croissant(release):
    """No error and no warning; every record set is read as its file reads."""
    import mlcroissant

    complaints = []
    handler = logging.Handler()
    handler.emit = lambda record: complaints.append(record.getMessage())
    logging.getLogger().addHandler(handler)
    dataset = mlcroissant.Dataset(jsonld=str(release / "croissant.json"))
    issues = dataset.metadata.ctx.issues
    assert not issues.errors and not issues.warnings, issues.report()
    for record_set in dataset.metadata.record_sets:
        lines = (release / "tables" / f"{record_set.id}.jsonl").read_text().splitlines()
        records = list(dataset.records(record_set.id))
        assert len(records) == len(lines), (record_set.id, len(records), len(lines))
        for record, line in zip(records[:50], lines[:50]):
            for name, value in json.loads(line).items():
                found = record[f"{record_set.id}/{name}"]
                assert plain(found) == value, (record_set.id, name, found, value)
        print(f"  {record_set.id}: {len(records)} records")
    assert not complaints, complaints


def plain(value):
    """A value of mlcroissant as JSON has it."""
    if isinstance(value, bytes):
        return value.decode()
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    return value


def check_card(release):
    """The Hub's library reads the front matter, and each configuration loads."""
    import datasets
    from huggingface_hub import DatasetCard

    card = DatasetCard.load(release / "README.md", repo_type="dataset")
    for config in card.data.to_dict()["configs"]:
        entry = config["data_files"][0]
        table = datasets.load_dataset(str(release), config["config_name"], split=entry["split"])
        lines = (release / entry["path"]).with_suffix(".jsonl").read_text().splitlines()
        assert table.to_list() == [json.loads(line) for line in lines], config
        print(f"  {config['config_name']}: {len(table)} rows, {', '.join(table.column_names)}")


def check_citation(release):
    subprocess.run(
        [sys.executable, "-m", "cffconvert.cli.cli", "--validate", "-i", release / "CITATION.cff"], check=True
    )


if __name__ == "__main__":
    folder = Path(sys.argv[1]).resolve()
    for name, check in [("mlcroissant", check_croissant), ("datasets", check_card), ("cffconvert", check_citation)]:
        check(folder)
        print(f"{name}: ok")
