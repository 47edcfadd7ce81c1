"""Scores a submission to a competition with the package l4d, as `l4d score` does.

    python3 score.py REFERENCE SUBMISSION OUTPUT

REFERENCE holds the benchmark and competition.json; SUBMISSION is a folder or zip with method.json and masks/, at the
top or in one folder; OUTPUT receives scores.json and counts.csv. Where Python has no l4d, the wheel beside this file is
installed into a temporary folder, without a network.
"""

import glob
import io
import json
import os
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import zipfile
import zlib

HERE = os.path.dirname(os.path.abspath(__file__))
# No sound submission has more. A zip that has is refused before more of it is read.
MAX_ENTRIES = 20000
MAX_MEGABYTES = 64
# The list of files at the end of a zip.
MAX_LIST_BYTES = 8 << 20
# More problems than a person reads.
MAX_PROBLEMS = 40
# What `zipfile` raises over bytes that are no zip.
BROKEN = (zipfile.BadZipFile, zlib.error, struct.error, OSError, EOFError, RuntimeError, ValueError, IndexError, OverflowError)
GROUPS = ("attribute", "action", "spatial", "interaction", "outdoor", "room", "tabletop")
BASELINES = ("oracle", "time-agnostic", "look-alike-union", "random-look-alike", "all", "none")


class Refusal(Exception):
    """A submission that cannot be scored; says why to its author."""


class ListedFile(io.FileIO):
    """A zip on disk. `zipfile` reads the list of entries at once, before its length can be checked."""

    is_listed = False

    def read(self, size=-1):
        if self.is_listed:
            return super().read(size)
        data = super().read(MAX_LIST_BYTES + 1 if size < 0 else min(size, MAX_LIST_BYTES + 1))
        if len(data) > MAX_LIST_BYTES:
            raise Refusal("the list of files in the archive is longer than %d bytes" % MAX_LIST_BYTES)
        return data


def unpack(path, folder):
    """Writes the files of a zip below a folder, none of them outside it, up to the limits above."""
    try:
        with ListedFile(path) as file, zipfile.ZipFile(file) as archive:
            file.is_listed = True
            entries = [entry for entry in archive.infolist() if not entry.filename.endswith("/")]
            if len(archive.infolist()) > MAX_ENTRIES:
                raise Refusal("there are more than %d files and folders" % MAX_ENTRIES)
            left = MAX_MEGABYTES << 20
            for entry in entries:
                left -= unpack_entry(archive, entry, folder, left)
    except BROKEN as error:
        raise Refusal("the archive cannot be read: %s" % ascii(str(error)[:120]))


def unpack_entry(archive, entry, folder, most):
    """Writes one file; its size in bytes."""
    parts = entry.filename.split("/")
    if any(part in ("", ".", "..") or "\\" in part or ":" in part for part in parts):
        raise Refusal("%s is no path below the archive" % ascii(entry.filename[:120]))
    if entry.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
        raise Refusal("%s has to be stored or deflated" % ascii(entry.filename[:120]))
    target = os.path.join(folder, *parts)
    if os.path.exists(target):
        raise Refusal("%s is in the archive twice" % ascii(entry.filename[:120]))
    with archive.open(entry) as file:
        # A header may lie about the size of what is packed.
        data = file.read(most + 1)
    if len(data) > most:
        raise Refusal("the files are larger than %d MB" % MAX_MEGABYTES)
    os.makedirs(os.path.dirname(target), exist_ok=True)
    with open(target, "wb") as file:
        file.write(data)
    return len(data)


def named(submission, folder):
    """A link to the folder with method.json, called as the method: so l4d wants it."""
    inside = [entry.path for entry in os.scandir(submission) if entry.is_dir(follow_symlinks=False)]
    cards = [os.path.join(place, "method.json") for place in [submission] + inside]
    cards = [card for card in cards if os.path.isfile(card) and not os.path.islink(card)]
    if len(cards) != 1:
        raise Refusal("method.json has to be there once, at the top or in one folder; it is there %d times" % len(cards))
    try:
        with open(cards[0], "rb") as file:
            name = json.loads(file.read(1 << 20).decode("utf-8"))["name"]
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        name = None
    # Otherwise l4d says what is wrong with it.
    is_plain = isinstance(name, str) and re.fullmatch("[A-Za-z0-9_-][A-Za-z0-9_.-]{0,99}", name)
    link = os.path.join(folder, name if is_plain else "submission")
    os.symlink(os.path.abspath(os.path.dirname(cards[0])), link)
    return link


def load_l4d(folder):
    """The package l4d; the wheel beside this file is installed into `folder` if Python has none."""
    try:
        import l4d
    except ImportError:
        pip = [sys.executable, "-m", "pip", "install", "--quiet", "--no-index", "--no-deps", "--target", folder]
        subprocess.run(pip + glob.glob(os.path.join(HERE, "*.whl")), check=True)
        sys.path.insert(0, folder)
        import l4d
    return l4d


def refuse(problems):
    if problems:
        more = len(problems) - MAX_PROBLEMS
        raise Refusal("\n".join(problems[:MAX_PROBLEMS] + (["and %d more" % more] if more > 0 else [])))


def score(l4d, reference, submission, scores):
    """The summary of the one method of a submission; its counts.csv is written below `scores`."""
    with open(os.path.join(reference, "competition.json"), encoding="utf-8") as file:
        competition = json.load(file)
    benchmark = l4d.Benchmark(os.path.join(reference, "benchmark"), competition["profile"])
    try:
        found = l4d.check(submission, benchmark, max_megabytes=MAX_MEGABYTES)
        refuse([str(finding).replace(submission, ".") for finding in found if finding.severity == "error"])
        document = l4d.score(submission, benchmark, scores=scores, max_megabytes=MAX_MEGABYTES)
    except l4d.L4dError as error:
        raise Refusal(str(error).replace(submission, "."))
    method = document["methods"][0]
    refuse(unranked(method, competition["track"]))
    return method


def unranked(method, track):
    """Why a method cannot be ranked in this competition."""
    problems = []
    if method.get("baseline") or method["name"] in BASELINES:
        problems.append("method.json: baselines are not ranked; the names %s are theirs" % ", ".join(BASELINES))
    if method["used"]["ground_truth"]:
        problems.append("method.json: results that used the ground truth are not ranked")
    if method["used"].get("depth", False) != (track == "colour+depth"):
        learned = "did not learn" if track == "colour+depth" else "learned"
        problems.append("method.json: what %s from rendered depth is ranked in another track; here it is %s" % (learned, track))
    return problems


def columns(method):
    """Percentages by column of the leaderboard; 0 where there is no value, since platforms know no gap."""
    scores = {key: method[key] for key in ("miou", "macc", "acc25", "acc50", "tube_iou", "select", "queries")}
    scores["fpr"] = method["false_positive_rate"]
    groups = dict(method["categories"], **method["scales"])
    scores.update(("miou_" + name, groups.get(name, {}).get("miou")) for name in GROUPS)
    return {key: 0.0 if value is None else value for key, value in scores.items()}


def main(reference, submission, output):
    with tempfile.TemporaryDirectory() as folder:
        try:
            if not os.path.isdir(submission):
                unpack(submission, os.path.join(folder, "submission"))
                submission = os.path.join(folder, "submission")
            os.mkdir(os.path.join(folder, "method"))
            submission = named(submission, os.path.join(folder, "method"))
            method = score(load_l4d(os.path.join(folder, "site")), reference, submission, os.path.join(folder, "scores"))
        except Refusal as refusal:
            print("The submission cannot be scored:\n%s" % refusal, file=sys.stderr)
            return 1
        os.makedirs(output, exist_ok=True)
        shutil.copy(os.path.join(folder, "scores", method["name"], "counts.csv"), output)
    with open(os.path.join(output, "scores.json"), "w", encoding="utf-8", newline="\n") as file:
        json.dump(columns(method), file, indent=2)
        file.write("\n")
    return 0


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
