"""Runs the evaluator of another method on the files that `tests/originals.rs` wrote, and prints its numbers as JSON.

    python tests/originals.py NAME CHECKOUTS FOLDER

CHECKOUTS holds the repositories under their names on GitHub. Their code runs as it is, on a processor; what it would ask of
CLIP and E5 is read from `clip.npz` and `e5.npz`. Needs numpy, torch, torchvision, opencv-python-headless, pillow,
scikit-learn, scikit-image, scipy, matplotlib, seaborn, mediapy, tqdm, pandas and pycocotools.
"""

import contextlib
import io
import json
import os
import pathlib
import runpy
import shutil
import sys
import types

import numpy as np
from PIL import Image

NAME, CHECKOUTS, FOLDER = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])
ASKED = json.loads((FOLDER / "gt/queries.json").read_text())
SCENE, TEXTS, MOMENTS = ASKED["scene"], ASKED["texts"], 9
THEIRS = FOLDER / "theirs"


def main() -> None:
    os.environ["MPLBACKEND"] = "Agg"
    with contextlib.redirect_stdout(sys.stderr):
        numbers = globals()[NAME.replace("-", "_")]()
    print(json.dumps({key: float(value) for key, value in numbers.items()}))


def truth():
    """Number of a query, moment and file, of all pairs whose target is there."""
    for path in sorted((FOLDER / "gt").glob("*/*.png")):
        yield path.parent.name, int(path.stem), path


def script(path: str, *arguments: object, folder: pathlib.Path) -> str:
    """Runs a script of a checkout in a folder; gives what it printed."""
    printed = io.StringIO()
    file = CHECKOUTS / path
    sys.argv = [str(file), *map(str, arguments)]
    sys.path.insert(0, str(file.parent))
    os.chdir(folder)
    with contextlib.redirect_stdout(printed):
        runpy.run_path(str(file), run_name="__main__")
    return printed.getvalue()


def after(text: str, mark: str) -> float:
    """The number after the first mark."""
    return float(text.split(mark, 1)[1].split()[0].rstrip(","))


def gaussian_grouping() -> dict:
    work = FOLDER / "work"
    run = next(THEIRS.glob(f"{SCENE}/test/ours_*_text/test_mask"))
    shutil.copytree(run, work / "result/lerf_mask" / SCENE)
    for number, moment, path in truth():
        goal = work / "data/lerf_mask" / SCENE / "test_mask" / str(moment) / f"{TEXTS[number]}.png"
        goal.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(path, goal)
    printed = script("gaussian-grouping/script/eval_lerf_mask.py", SCENE, folder=work)
    return {"miou": after(printed, "Overall Mean IoU: "), "boundary_miou": after(printed, "Overall Boundary Mean IoU: ")}


def opengaussian() -> dict:
    """Its two functions; the loop around them has the scenes of LERF-OVS written into it."""
    module = runpy.run_path(str(CHECKOUTS / "OpenGaussian/scripts/compute_lerf_iou.py"))
    run = next(THEIRS.glob(f"{SCENE}/text2obj/ours_*/renders_cluster_silhouette"))
    ious = []
    for number, moment, path in truth():
        said = module["load_image_as_binary"](run / f"frame_{12 * moment:05d}_{TEXTS[number]}.png", is_png=True)
        ious.append(module["calculate_iou"](module["load_image_as_binary"](path), said))
    return {"miou": np.mean(ious)}


def refersplat() -> dict:
    """What precedes the two empty folders at the end of its script."""
    source = (CHECKOUTS / "ReferSplat/test_miou.py").read_text().split("render_dir=")[0]
    module: dict = {}
    exec(compile(source, "test_miou.py", "exec"), module)
    run = THEIRS / SCENE / "testccc/ours_4"
    (run / "gt").mkdir()
    wanted = {(number, moment): path for number, moment, path in truth()}
    for number, text in TEXTS.items():
        for moment in range(MOMENTS):
            mask = Image.open(wanted[number, moment]) if (number, moment) in wanted else Image.new("L", (128, 96))
            mask.convert("RGB").save(run / "gt" / f"{12 * moment:05d}{text}.png")
    return {"miou": module["calculate_iou_for_directory"](str(run / "renders"), str(run / "gt"))}


def mevis() -> dict:
    from pycocotools import mask as coco

    wanted = {(number, moment): path for number, moment, path in truth()}
    rows = {}
    for place, number in enumerate(TEXTS):
        masks = [wanted.get((number, moment)) for moment in range(MOMENTS)]
        masks = [None if path is None else np.asfortranarray(np.array(Image.open(path)) // 255) for path in masks]
        rows[str(place)] = [None if mask is None else coco.encode(mask) for mask in masks]
    for runs in rows.values():
        for run in filter(None, runs):
            run["counts"] = run["counts"].decode()
    expressions = {number: {"exp": text, "anno_id": [place]} for place, (number, text) in enumerate(TEXTS.items())}
    frames = [f"{moment:05d}" for moment in range(MOMENTS)]
    work = FOLDER / "work"
    work.mkdir()
    (work / "exp.json").write_text(json.dumps({"videos": {SCENE: {"frames": frames, "expressions": expressions}}}))
    (work / "masks.json").write_text(json.dumps(rows))
    # Started anew, workers would run this file and not the evaluator.
    import multiprocessing

    multiprocessing.set_start_method("fork")
    places = ["--mevis_exp_path", "exp.json", "--mevis_mask_path", "masks.json", "--mevis_pred_path", THEIRS]
    printed = script("MeViS/tools/eval_mevis.py", *places, "--save_name", work / "out.json", folder=work)
    assert len(json.loads((work / "out.json").read_text())) == len(TEXTS)
    return {"j": after(printed, "J: "), "f": after(printed, "F: "), "j_and_f": after(printed, "J&F: ")}


def davis() -> dict:
    """A sequence a query, since its objects are ours and a query may mean several."""
    sys.path.insert(0, str(CHECKOUTS / "davis2017-evaluation"))
    from davis2017.evaluation import DAVISEvaluation

    objects = {"001": [1], "002": [2], "003": [1], "004": [1, 2], "005": [3]}
    root, said = FOLDER / "work/davis", FOLDER / "work/said"
    wanted = {(number, moment): path for number, moment, path in truth()}
    names = []
    for number, ids in objects.items():
        if (number, 0) not in wanted:
            # Nothing is in the first picture: it would find no object.
            continue
        names.append(f"{SCENE}_{number}")
        for folder in (root / "JPEGImages/480p", root / "Annotations/480p", said):
            (folder / names[-1]).mkdir(parents=True)
        for moment in range(MOMENTS):
            file = f"{names[-1]}/{moment:05d}"
            palette = np.array(Image.open(THEIRS / f"{SCENE}_cam08/{moment:05d}.png"))
            Image.fromarray(np.isin(palette, ids).astype(np.uint8)).save(said / f"{file}.png")
            path = wanted.get((number, moment))
            mask = np.zeros((96, 128), np.uint8) if path is None else np.array(Image.open(path)) // 255
            Image.fromarray(mask).save(root / "Annotations/480p" / f"{file}.png")
            Image.new("RGB", (128, 96)).save(root / "JPEGImages/480p" / f"{file}.jpg")
    (root / "ImageSets/2017").mkdir(parents=True)
    (root / "ImageSets/2017/val.txt").write_text("\n".join(names))
    found = DAVISEvaluation(str(root), "semi-supervised", "val").evaluate(str(said))
    numbers = {f"{kind.lower()}{end}": np.mean(found[kind][key]) for kind in "JF" for key, end in (("M", "_mean"), ("R", "_recall"), ("D", "_decay"))}
    return numbers | {"j_and_f": (numbers["j_mean"] + numbers["f_mean"]) / 2}


def models() -> None:
    """Puts files in the place of CLIP and E5, and the processor in that of the graphics card."""
    import torch

    clip, e5 = np.load(FOLDER / "clip.npz"), np.load(FOLDER / "e5.npz")
    known = dict(zip(clip["queries"], clip["positives"]))
    known |= dict(zip(("object", "things", "stuff", "texture"), clip["negatives"]))
    known[" "] = clip["positives"][0]
    phrases = list(known)

    class Model(torch.nn.Module):
        def encode_text(self, tokens):
            return torch.tensor(np.stack([known[phrases[int(token)]] for token in tokens[:, 0]]))

    class Sentences:
        def __init__(self, _name):
            self.known = dict(zip(e5["queries"], e5["positives"]))

        def encode(self, text, prompt_name=None):
            # It embeds base objects as well, and compares nothing with them.
            return self.known.get(text, next(iter(self.known.values())))

    stub = types.ModuleType("open_clip")
    stub.create_model_and_transforms = lambda *_, **__: (Model(), None, None)
    stub.get_tokenizer = lambda _: lambda phrase: torch.tensor([[phrases.index(phrase)]])
    sys.modules["open_clip"] = stub
    stub = types.ModuleType("sentence_transformers")
    stub.SentenceTransformer = Sentences
    sys.modules["sentence_transformers"] = stub
    torch.Tensor.cuda = lambda self, *_, **__: self


def langsplat() -> dict:
    labels = THEIRS / "label" / SCENE
    labels.mkdir(parents=True)
    for moment in range(MOMENTS):
        objects = []
        for number, other, path in truth():
            if other == moment:
                objects += [{"category": TEXTS[number], **shape} for shape in rectangles(path)]
        name = f"frame_{moment + 1:05d}"
        info = {"name": f"{name}.jpg", "width": 128, "height": 96}
        (labels / f"{name}.json").write_text(json.dumps({"info": info, "objects": objects}))
        Image.new("RGB", (128, 96)).save(labels / f"{name}.jpg")
    models()
    os.chdir(THEIRS)
    places = ["--feat_dir", THEIRS / "output", "--ae_ckpt_dir", THEIRS / "autoencoder/ckpt", "--json_folder", THEIRS / "label"]
    widths = ["--encoder_dims", 3, "--decoder_dims", 6, 12]
    sys.path.insert(0, str(CHECKOUTS / "LangSplat"))
    script("LangSplat/eval/evaluate_iou_loc.py", "--dataset_name", SCENE, *places, "--output_dir", THEIRS / "eval_result", *widths, folder=THEIRS)
    log = next((THEIRS / "eval_result" / SCENE).glob("*.log")).read_text()
    return {"miou": after(log, "iou chosen: "), "localisation": after(log, "Localization accuracy: ")}


def rectangles(path: pathlib.Path) -> list:
    """A mask of rectangles beside each other as polygons through the pixels of their borders."""
    import cv2

    contours, _ = cv2.findContours(np.array(Image.open(path)), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
    shapes = []
    for contour in contours:
        points = contour.reshape(-1, 2)
        low, high = points.min(0).tolist(), points.max(0).tolist()
        shapes.append({"segmentation": points.tolist(), "bbox": low + high})
    return shapes


def four_d_langsplat() -> dict:
    models()
    data, output = THEIRS / f"data/hypernerf/{SCENE}", THEIRS / f"output/hypernerf/{SCENE}"
    os.environ["ExpsDir"] = str(THEIRS / "output")
    sys.path.insert(0, str(CHECKOUTS / "4DLangSplat"))
    (THEIRS / "eval").mkdir()
    script(
        "4DLangSplat/eval/eval.py", "--dataset_type", "hypernerf", "--annotation_folder", data / "annotations",
        "--exp_name", f"{SCENE}/{SCENE}", "--feat_dim", 3, "--video_feat_dim", 6, "--iterations", 10000,
        "--video_eval_iterations", 20000, "--ae_ckpt_path", output / "clip_best_ckpt.pth",
        "--video_ae_ckpt_path", output / "video_best_ckpt.pth", "--video_feat_dir", f"{SCENE}/{SCENE}",
        "--apply_video_search", "--smooth_feature_post", "--visualize_results", "--detail_results",
        "--encoder_hidden_dims", 3, "--decoder_hidden_dims", 6, 12,
        "--video_encoder_hidden_dims", 6, "--video_decoder_hidden_dims", 12, 12, folder=THEIRS / "eval",
    )  # fmt: skip
    log = next((THEIRS / "eval/eval_result").glob("*/*/*/*.log")).read_text()
    ious = {line.split("key:")[1].split(", mean")[0]: after(line, "mean_iou:") for line in log.splitlines() if ", mean_iou:" in line}
    video = next(line for line in log.splitlines() if "Video: " in line)
    sentences = [iou for text, iou in ious.items() if text in TEXTS.values()]
    return {
        "miou": np.mean(sentences), "miou_with_base_objects": after(log, "Mean IoU: "),
        "viou": after(video, "Average vIoU: "), "acc": after(video, "Average Accuracy: "),
    }


main()
