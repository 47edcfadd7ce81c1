"""Queries, truth, results, scores and findings."""

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

import l4d

QUERIES = ["ball/001", "ball/002", "ball/003"]


def test_queries_say_what_their_file_says(benchmark: l4d.Benchmark, world: Path) -> None:
    lines = [json.loads(line) for line in (world / "benchmark/queries/ball.jsonl").read_text().splitlines()]
    queries = benchmark.queries("ball")
    assert [query.id for query in queries] == QUERIES == [query.id for query in benchmark.queries()]
    for query, line in zip(queries, lines):
        for field in ("text", "categories", "referents", "temporal", "predicate", "status"):
            assert getattr(query, field) == line[field]
        assert [list(interval) for interval in query.intervals] == line["frames"] and query.scene == "ball"
    last = queries[-1]
    assert [last.holds_at(frame) for frame in (23, 24, 72, 73)] == [False, True, True, False]
    assert benchmark.queries("ball", set="absents") == [] == benchmark.queries(set="composites")
    assert benchmark.query("ball/002").text == queries[1].text == benchmark.query(queries[1]).text
    assert (benchmark.name, benchmark.version, benchmark.scenes) == ("Made up", "0.1.0", ["ball"])
    assert (benchmark.width, benchmark.height, benchmark.frames) == (128, 96, list(range(0, 97, 12)))


def test_the_shipped_benchmark_needs_no_render(root: Path) -> None:
    benchmark = l4d.Benchmark(root / "benchmark", profile="tiny")
    assert len(benchmark.queries()) == 289 and len(benchmark.scenes) == 21
    query = benchmark.query("tabletop_tea/001")
    first = json.loads((root / "benchmark/queries/tabletop_tea.jsonl").read_text().splitlines()[0])
    assert query.predicate == first["predicate"] is not None and query.text == first["text"]
    tracks = json.loads((root / "benchmark/scenes/tabletop_tea.json").read_text())
    cameras = {camera.name: camera for camera in benchmark.cameras("tabletop_tea")}
    assert len(cameras) == 5
    for tracked in tracks["cameras"]:
        if "tiny" in tracked["profiles"]:
            camera = cameras[tracked["name"]]
            assert camera.world_from_camera().ravel().tolist() == tracked["world_from_camera"][0]
            assert camera.fx == camera.fy == tracked["focal_over_width"] * 128 and camera.cx == 64
    assert benchmark.test_camera("tabletop_tea").split == "test"
    names = [instance.name for instance in benchmark.instances("tabletop_tea")]
    assert names == [instance["name"] for instance in tracks["instances"]] and benchmark.events("tabletop_tea")
    truth = benchmark.truth("tabletop_tea")
    assert truth.masks(query).any() and truth.instances == names


def test_truth_is_that_of_the_pictures(benchmark: l4d.Benchmark, scene: l4d.Scene, world: Path) -> None:
    truth = benchmark.truth("ball")
    ids = scene.clip("cam04").id
    masks = truth.masks("ball/001")
    assert masks.dtype == np.bool_ and masks.shape == (9, 96, 128) and truth.frames == benchmark.frames
    assert np.array_equal(masks, ids == 1) and np.array_equal(truth.instance_masks("ball_b"), ids == 2)
    gated = truth.masks("ball/003")
    assert not gated[:2].any() and np.array_equal(gated[2:7], ids[2:7] == 1) and not gated[7:].any()
    assert np.array_equal(truth.mask("ball/001", 48), masks[4])
    encoded = json.loads((world / "benchmark/truth/tiny/ball.json").read_text())["instances"][0]["masks"]["0048"]
    assert l4d.rle_encode(masks[4]) == encoded
    assert np.array_equal(l4d.rle_decode(encoded, 96, 128), masks[4])
    for call in (
        lambda: truth.mask("ball/001", 1),
        lambda: truth.masks("ball/999"),
        lambda: truth.masks("garden/001"),
        lambda: truth.masks(7),
        lambda: l4d.rle_decode("~", 96, 128),
        lambda: l4d.rle_decode("0", 1 << 40, 1),
    ):
        with pytest.raises(l4d.L4dError) as told:
            call()
        assert told.value.field and told.value.hint


def test_scores_are_those_of_the_verb_to_the_last_bit(benchmark: l4d.Benchmark, world: Path, tmp_path: Path) -> None:
    said = json.loads((world / "score.json").read_text())
    document = l4d.score(world / "results", benchmark, scores=tmp_path)
    assert document == said
    assert [method["name"] for method in document["methods"]] == ["oracle", "random-look-alike", "time-agnostic"]
    inexact = [value for value in document["methods"][2]["averages"]["micro"].values() if value != round(value, 6)]
    assert inexact, "no number here would show a lost bit"
    assert (tmp_path / "oracle/counts.csv").read_text().startswith("scene,query,frame,state")
    assert l4d.score(world / "results/oracle", benchmark)["methods"][0]["miou"] == 100.0


def test_findings_are_those_of_the_verb(benchmark: l4d.Benchmark, world: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(world)
    said = json.loads((world / "findings.json").read_text())["findings"]
    found = l4d.check("damaged", benchmark)
    fields = {"code": "code", "severity": "severity", "path": "path", "where": "place", "message": "message"}
    told = [{key: finding[key] for key in fields} for finding in said]
    assert [{key: getattr(finding, name) for key, name in fields.items()} for finding in found] == told
    # Commands in the hints of the verb have the folders that were named to it.
    for finding, line in zip(found, said):
        assert line["hint"].split("`l4d")[0] == finding.hint.split("`l4d")[0]
    assert {"L4D302", "L4D305", "L4D310"} <= {finding.code for finding in found}
    assert l4d.check("results", benchmark) == []
    refused = l4d.score("damaged", benchmark)
    assert refused["methods"] == [] and refused["findings"]


def test_what_is_written_is_scored(benchmark: l4d.Benchmark, tmp_path: Path) -> None:
    writer = l4d.ResultsWriter(tmp_path / "mine", benchmark, version="1", ground_truth=True, depth=True, endpoints=["none"])
    truth = benchmark.truth("ball")
    assert [query.id for query in writer.remaining()] == QUERIES and writer.name == "mine"
    assert {finding.code for finding in l4d.check(writer.path, benchmark)} == {"L4D308"}
    writer.write(QUERIES[0], truth.masks(QUERIES[0]))
    masks = truth.masks(QUERIES[1]).transpose(2, 1, 0).copy().transpose(2, 1, 0)
    writer.write(benchmark.query(QUERIES[1]), {frame: masks[at] for at, frame in enumerate(benchmark.frames)})
    assert [query.id for query in writer.remaining("ball")] == QUERIES[2:]

    again = l4d.ResultsWriter(
        tmp_path / "mine", benchmark, version="1", ground_truth=True, depth=True, endpoints=["none"]
    )
    assert [query.id for query in again.remaining()] == QUERIES[2:]
    gated = {frame: None if not 24 <= frame <= 72 else truth.mask(QUERIES[2], frame) for frame in benchmark.frames}
    again.write(QUERIES[2], gated)
    again.finish(1.5)
    assert again.remaining() == [] and l4d.check(again.path, benchmark) == []
    document = l4d.score(tmp_path / "mine", benchmark)
    assert [document["methods"][0][metric] for metric in ("miou", "tube_iou", "select")] == [100.0] * 3
    card = json.loads((tmp_path / "mine/method.json").read_text())
    assert card["seconds"] == 1.5 and card["truth_digest"] == benchmark.truth_digest
    assert card["used"] == {"ground_truth": True, "test_view": False, "depth": True, "endpoints": ["none"]}

    # The same bytes as the baseline's, which Rust wrote.
    l4d.write_baseline("oracle", benchmark, tmp_path)
    for query in QUERIES:
        mine, oracle = (tmp_path / method / "masks" / f"{query}.json" for method in ("mine", "oracle"))
        assert mine.read_bytes() == oracle.read_bytes()
    assert not list(tmp_path.rglob("*.tmp"))


def test_a_folder_of_another_run_is_refused(benchmark: l4d.Benchmark, tmp_path: Path) -> None:
    nothing = np.zeros((9, 96, 128), bool)
    l4d.ResultsWriter(tmp_path / "mine", benchmark, version="1").write(QUERIES[0], nothing)
    with pytest.raises(l4d.L4dError) as told:
        l4d.ResultsWriter(tmp_path / "mine", benchmark, version="2")
    assert told.value.field == "field `version`" and "overwrite=True" in told.value.hint
    fresh = l4d.ResultsWriter(tmp_path / "mine", benchmark, version="2", overwrite=True)
    assert [query.id for query in fresh.remaining()] == QUERIES
    fresh.write(QUERIES[0], nothing)
    (tmp_path / "mine/method.json").unlink()
    with pytest.raises(l4d.L4dError, match="no method.json"):
        l4d.ResultsWriter(tmp_path / "mine", benchmark, version="2")


def test_a_torn_file_is_answered_again(benchmark: l4d.Benchmark, tmp_path: Path) -> None:
    writer = l4d.ResultsWriter(tmp_path / "mine", benchmark, version="1")
    for query in writer.remaining():
        writer.write(query, np.zeros((9, 96, 128), bool))
    path = tmp_path / "mine/masks/ball/002.json"
    path.write_bytes(path.read_bytes()[:-20])
    assert [query.id for query in writer.remaining()] == ["ball/002"]


@pytest.mark.parametrize(
    "masks",
    [
        np.zeros((9, 96, 128), np.float32),
        np.zeros((9, 128, 96), bool),
        np.zeros((96, 128), bool),
        {0: np.zeros((96, 128), bool)},
        {frame: np.zeros((96, 127), bool) for frame in range(0, 97, 12)},
        {frame: None for frame in range(97)},
        {"0000": None},
        None,
    ],
    ids=["floats", "turned", "one-frame", "frames-missing", "too-narrow", "other-frames", "text-keys", "none"],
)
def test_what_is_no_answer_is_refused(benchmark: l4d.Benchmark, tmp_path: Path, masks: object) -> None:
    writer = l4d.ResultsWriter(tmp_path / "mine", benchmark, version="1")
    with pytest.raises(l4d.L4dError) as told:
        writer.write(QUERIES[0], masks)
    assert told.value.field.startswith("masks") and told.value.hint
    assert not (tmp_path / "mine/masks").exists()


def test_hostile_names_do_not_leave_the_folder(benchmark: l4d.Benchmark, tmp_path: Path) -> None:
    for method in ("..", "a b", ".hidden"):
        with pytest.raises(l4d.L4dError):
            l4d.ResultsWriter(tmp_path / "results" / method, benchmark, version="1")
    writer = l4d.ResultsWriter(tmp_path / "results/mine", benchmark, version="1")
    for query in ("../../x/001", "ball/../../001", "ball/999", "ball"):
        with pytest.raises(l4d.L4dError):
            writer.write(query, np.zeros((9, 96, 128), bool))
    assert [path.name for path in tmp_path.iterdir()] == ["results"]


def test_arguments_that_cannot_be_are_named(benchmark: l4d.Benchmark, world: Path) -> None:
    for field, call in {
        "profile": lambda: l4d.Benchmark(world / "benchmark", profile="huge"),
        "set": lambda: benchmark.queries(set="all"),
        "missing": lambda: l4d.score(world / "results", benchmark, missing="guess"),
        "hit_iou": lambda: l4d.score(world / "results", benchmark, hit_iou=1.0),
        "name": lambda: l4d.write_baseline("best", benchmark, world / "results"),
        "field `scenes`": lambda: l4d.score(world / "results", benchmark, scenes=["garden"]),
    }.items():
        with pytest.raises(l4d.L4dError) as told:
            call()
        assert told.value.field == field and told.value.hint


def test_a_method_may_leave_frames_out_and_say_so(benchmark: l4d.Benchmark, world: Path, tmp_path: Path) -> None:
    shutil.copytree(world / "results/oracle", tmp_path / "oracle")
    (tmp_path / "oracle/masks/ball/002.json").unlink()
    assert l4d.score(tmp_path, benchmark)["methods"] == []
    skipped = l4d.score(tmp_path, benchmark, missing="skip")["methods"][0]
    zero = l4d.score(tmp_path, benchmark, missing="zero")["methods"][0]
    assert skipped["partial"] and not zero["partial"] and zero["miou"] < skipped["miou"] == 100.0
