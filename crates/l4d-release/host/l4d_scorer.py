"""Scores masks against the truth of a benchmark, with Python's standard library alone.

The definitions are those of `l4d score` (docs/scoring.md), whose counts.csv this program gives byte for byte and whose
numbers it gives: tests of the project compare both. It runs where no other program can be installed, executes nothing
that was submitted, unpacks nothing, and follows no link.

    python3 l4d_scorer.py REFERENCE SUBMISSION OUTPUT

REFERENCE and SUBMISSION are folders or zip files, OUTPUT receives scores.json and counts.csv.
Needs Python 3.7.
"""

import json
import os
import sys
import zipfile

# No sound file is larger. A submission that is, is refused before it is read.
MAX_FILE_BYTES = 64 << 20
MAX_FILES = 200000
HEADER = "scene,query,frame,state,intersection,union,predicted,truth,instance,instance_overlap"
CATEGORIES = ["attribute", "action", "spatial", "interaction"]
SCALES = ["outdoor", "room", "tabletop"]
COLUMNS = ["miou", "macc", "acc25", "acc50", "tube_iou", "select", "fpr"]
# Nobody competes under these names.
BASELINES = ["oracle", "time-agnostic", "look-alike-union", "random-look-alike", "all", "none"]
# More problems than a person reads.
MAX_PROBLEMS = 40


class Refusal(Exception):
    """A submission that cannot be scored; says why to the one who submitted it."""


# ---- files -----------------------------------------------------------------------------------------------------


class Folder:
    """Files below a folder, by relative path; links are not followed."""

    def __init__(self, root):
        self.root = root
        self.sizes = {}
        for place, folders, files in os.walk(root, followlinks=False):
            folders.sort()
            for name in files:
                path = os.path.join(place, name)
                if not os.path.islink(path) and os.path.isfile(path):
                    relative = os.path.relpath(path, root).replace(os.sep, "/")
                    self.sizes[relative] = os.path.getsize(path)
            if len(self.sizes) > MAX_FILES:
                raise Refusal("there are more than %d files" % MAX_FILES)

    def read(self, name):
        with open(os.path.join(self.root, *name.split("/")), "rb") as file:
            return bounded(name, file)


class Archive:
    """Files of a zip, by path; they are read one by one and never unpacked to a disk."""

    def __init__(self, path):
        try:
            self.archive = zipfile.ZipFile(path)
            entries = self.archive.infolist()
        except (zipfile.BadZipFile, OSError, ValueError, NotImplementedError) as error:
            raise Refusal("the archive cannot be read: %s" % error)
        if len(entries) > MAX_FILES:
            raise Refusal("there are more than %d files" % MAX_FILES)
        self.sizes = {entry.filename: entry.file_size for entry in entries if not entry.filename.endswith("/")}

    def read(self, name):
        try:
            with self.archive.open(name) as file:
                return bounded(name, file)
        except (zipfile.BadZipFile, OSError, RuntimeError, NotImplementedError, EOFError, ValueError) as error:
            raise Refusal("%s cannot be read: %s" % (shown(name), error))


def bounded(name, file):
    # A header may lie about the size of what is packed.
    data = file.read(MAX_FILE_BYTES + 1)
    if len(data) > MAX_FILE_BYTES:
        raise Refusal("%s is larger than %d bytes" % (shown(name), MAX_FILE_BYTES))
    return data


def open_files(path):
    return Folder(path) if os.path.isdir(path) else Archive(path)


def read_json(files, name):
    try:
        return json.loads(files.read(name).decode("utf-8"), parse_constant=refuse_constant)
    except (ValueError, RecursionError) as error:
        raise Refusal("%s is no JSON: %s" % (shown(name), error))


def refuse_constant(name):
    raise ValueError("%s is no number" % name)


def shown(text):
    """A text of a stranger, for a log."""
    return ascii(str(text)[:120])


# ---- masks as runs ---------------------------------------------------------------------------------------------


def decode(text, pixels):
    """Compressed COCO run lengths as [first, end) of each inner run, ascending."""
    counts = []
    place = 0
    while place < len(text):
        value = shift = 0
        while True:
            if place >= len(text) or shift > 35:
                raise ValueError("the last number is not complete")
            bits = ord(text[place]) - 48
            place += 1
            if not 0 <= bits < 64:
                raise ValueError("a character that run lengths do not have")
            value |= (bits & 31) << shift
            shift += 5
            if not bits & 32:
                if bits & 16:
                    value -= 1 << shift
                break
        if len(counts) > 2:
            value += counts[-2]
        if value < 0:
            raise ValueError("a negative run")
        counts.append(value)
    if sum(counts) != pixels:
        raise ValueError("%d pixels instead of %d" % (sum(counts), pixels))
    runs = []
    end = 0
    for index, count in enumerate(counts):
        if index % 2 and count:
            # Runs of nothing in between join their neighbours.
            if runs and runs[-1][1] == end:
                runs[-1] = (runs[-1][0], end + count)
            else:
                runs.append((end, end + count))
        end += count
    return runs


def area(runs):
    return sum(end - first for first, end in runs)


def overlap(one, other):
    shared = i = j = 0
    while i < len(one) and j < len(other):
        first = max(one[i][0], other[j][0])
        end = min(one[i][1], other[j][1])
        if end > first:
            shared += end - first
        if one[i][1] < other[j][1]:
            i += 1
        else:
            j += 1
    return shared


def union(masks):
    runs = []
    for first, end in sorted(run for mask in masks for run in mask):
        if runs and first <= runs[-1][1]:
            runs[-1] = (runs[-1][0], max(end, runs[-1][1]))
        else:
            runs.append((first, end))
    return runs


# ---- the benchmark ---------------------------------------------------------------------------------------------


class Scene:
    """Truth and queries of a scene."""

    def __init__(self, files, name):
        truth = read_json(files, "truth/%s.json" % name)
        self.name = name
        self.scale = truth["scale"]
        self.size = [truth["height"], truth["width"]]
        self.pixels = truth["height"] * truth["width"]
        self.frames = truth["frames"]
        self.clip = sorted(truth["frames"] + truth.get("unannotated", []))
        self.instances = []
        for instance in sorted(truth["instances"], key=lambda instance: instance["id"]):
            masks = {int(key): decode(counts, self.pixels) for key, counts in instance["masks"].items()}
            self.instances.append((instance["name"], masks))
        lines = files.read("queries/%s.jsonl" % name).decode("utf-8").splitlines()
        queries = [json.loads(line) for line in lines if line.strip()]
        self.queries = [query for query in queries if query["status"] != "rejected"]

    def target(self, query, frame):
        """What is to be found, as runs; nothing where the sentence does not hold."""
        if query["temporal"] == "while" and not holds(query, frame):
            return []
        return union([masks.get(frame, []) for name, masks in self.instances if name in query["referents"]])


def holds(query, frame):
    return any(first <= frame <= last for first, last in query["frames"])


# ---- the submission --------------------------------------------------------------------------------------------


class Submission:
    """method.json and masks/<scene>/<nnn>.json, at the top or in one folder."""

    def __init__(self, files, reference):
        self.files = files
        cards = [name for name in files.sizes if name == "method.json" or name.count("/") == 1 and name.endswith("/method.json")]
        if len(cards) != 1:
            raise Refusal("method.json has to stand once, at the top or in one folder; it stands there %d times" % len(cards))
        self.prefix = cards[0][: -len("method.json")]
        card = read_json(files, cards[0])
        if not isinstance(card, dict):
            raise Refusal("method.json is no object")
        for field, meaning in [("profile", "profile"), ("truth_digest", "truth")]:
            if card.get(field) != reference[field]:
                raise Refusal(
                    "method.json: field `%s` is %s, but the %s here is %s" % (field, shown(card.get(field)), meaning, reference[field])
                )
        if not isinstance(card.get("benchmark_version"), str) or card["benchmark_version"] != reference["version"]:
            raise Refusal("method.json: field `benchmark_version` is %s, but this is version %s" % (shown(card.get("benchmark_version")), reference["version"]))
        if card.get("protocol") != "l4d":
            raise Refusal("method.json: field `protocol` has to be l4d")
        used = card.get("used")
        if not isinstance(used, dict) or not isinstance(used.get("ground_truth"), bool) or not isinstance(used.get("test_view"), bool):
            raise Refusal("method.json: field `used` has to say whether ground_truth and test_view were used")
        if used["ground_truth"]:
            raise Refusal("method.json: results that used the ground truth are not ranked")
        if card.get("baseline", False) is not False or card.get("name") in BASELINES:
            raise Refusal("method.json: baselines are not ranked; the names %s are theirs" % ", ".join(BASELINES))

    def answers(self, scene, query, problems):
        """Frame -> runs, or None for absent; frames without an answer are not in it."""
        number = query["id"].split("/")[1]
        name = "%smasks/%s/%s.json" % (self.prefix, scene.name, number)
        place = "masks/%s/%s.json" % (scene.name, number)
        if name not in self.files.sizes:
            problems.append("%s: is missing" % place)
            return {}
        try:
            document = read_json(self.files, name)
            if not isinstance(document, dict) or set(document) != {"size", "frames"}:
                raise Refusal("has to hold `size` and `frames`, nothing else")
            if document["size"] != scene.size or not isinstance(document["frames"], dict):
                raise Refusal("`size` is %s, but the truth has %s" % (shown(document["size"]), scene.size))
            answers = {}
            for key, counts in document["frames"].items():
                if len(key) != 4 or not key.isdigit() or not key.isascii() or int(key) not in scene.clip:
                    raise Refusal("%s is no frame of the clip" % shown(key))
                if counts is not None and not isinstance(counts, str):
                    raise Refusal("frame %s is neither run lengths nor null" % key)
                try:
                    answers[int(key)] = None if counts is None else decode(counts, scene.pixels)
                except ValueError as error:
                    raise Refusal("frame %s: %s" % (key, error))
        except Refusal as refusal:
            problems.append("%s: %s" % (place, refusal))
            return {}
        missing = [frame for frame in scene.frames if frame not in answers]
        if missing:
            problems.append("%s: %d frames have no answer, the first is %04d" % (place, len(missing), missing[0]))
        return answers


# ---- counts and ratios -----------------------------------------------------------------------------------------


def count(scene, query, frame, answers):
    """A row of counts.csv: state, intersection, union, predicted, truth, instance, instance_overlap."""
    if frame not in scene.frames:
        return ("not_annotated", 0, 0, 0, 0, "", 0)
    target = scene.target(query, frame)
    predicted = answers.get(frame) or []
    shared = overlap(target, predicted)
    wanted, found = area(target), area(predicted)
    leader, most = "", 0
    for name, masks in scene.instances:
        here = overlap(masks.get(frame, []), predicted)
        # A mask that fits two things equally well has chosen neither.
        dethrones = leader in query["referents"] and name not in query["referents"]
        if here > most or (here == most and here > 0 and dethrones):
            leader, most = name, here
    if wanted > 0:
        state = "hit" if shared > 0 else "miss"
    else:
        state = "false_alarm" if found > 0 else "true_absent"
    return (state, shared, wanted + found - shared, found, wanted, leader, most)


def ratio(part, whole):
    return part / whole if whole else None


def ratios(query, rows):
    """The metrics of one query, 0 to 1; None where there is none."""
    present = [row for row in rows if row[0] != "not_annotated" and row[4] > 0]
    absent = [row for row in rows if row[0] != "not_annotated" and row[4] == 0]
    ious = [row[1] / row[2] for row in present]
    overlaps = {}
    for row in rows:
        if row[5]:
            overlaps[row[5]] = overlaps.get(row[5], 0) + row[6]
    meant = max([pixels for name, pixels in overlaps.items() if name in query["referents"]], default=0)
    other = max([pixels for name, pixels in overlaps.items() if name not in query["referents"]], default=0)
    frames = len(present)
    return {
        "miou": ratio(sum(ious), frames),
        "macc": ratio(sum(iou > 0 for iou in ious), frames),
        "acc25": ratio(sum(iou > 0.25 for iou in ious), frames),
        "acc50": ratio(sum(iou > 0.5 for iou in ious), frames),
        "tube_iou": ratio(sum(row[1] for row in rows), sum(row[2] for row in rows)) if frames else None,
        "select": float(meant > other) if frames else None,
        "fpr": ratio(sum(row[3] > 0 for row in absent), len(absent)),
    }


def mean(scored, column):
    """Mean over queries in percent; 0 where no query has a value, since platforms know no gap."""
    values = [numbers[column] for numbers in scored if numbers[column] is not None]
    return 100.0 * (sum(values) / len(values)) if values else 0.0


def score(reference_path, submission_path):
    """Scores in percent by column, and the text of counts.csv. Raises Refusal with everything that is wrong."""
    files = open_files(reference_path)
    reference = read_json(files, "reference.json")
    submission = Submission(open_files(submission_path), reference)
    problems, rows, scored = [], [HEADER], []
    for name in reference["scenes"]:
        scene = Scene(files, name)
        for query in scene.queries:
            answers = submission.answers(scene, query, problems)
            counted = [count(scene, query, frame, answers) for frame in scene.clip]
            number = query["id"].split("/")[1]
            for frame, row in zip(scene.clip, counted):
                rows.append("%s,%s,%d,%s" % (name, number, frame, ",".join(map(str, row))))
            scored.append((query, scene, ratios(query, counted)))
    if problems:
        more = len(problems) - MAX_PROBLEMS
        tail = ["and %d more" % more] if more > 0 else []
        raise Refusal("\n".join(problems[:MAX_PROBLEMS] + tail))
    scores = {column: mean([numbers for _, _, numbers in scored], column) for column in COLUMNS}
    for category in CATEGORIES:
        scores["miou_" + category] = mean([n for query, _, n in scored if category in query["categories"]], "miou")
    for scale in SCALES:
        scores["miou_" + scale] = mean([n for _, scene, n in scored if scene.scale == scale], "miou")
    scores["queries"] = sum(numbers["miou"] is not None for _, _, numbers in scored)
    return scores, "\n".join(rows) + "\n"


def main(reference, submission, output):
    try:
        scores, counts = score(reference, submission)
    except Refusal as refusal:
        print("The submission cannot be scored:\n%s" % refusal, file=sys.stderr)
        return 1
    os.makedirs(output, exist_ok=True)
    with open(os.path.join(output, "counts.csv"), "w", encoding="utf-8", newline="\n") as file:
        file.write(counts)
    with open(os.path.join(output, "scores.json"), "w", encoding="utf-8", newline="\n") as file:
        json.dump(scores, file, indent=2)
        file.write("\n")
    return 0


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
