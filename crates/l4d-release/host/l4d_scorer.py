"""Scores masks against the truth of a benchmark, with Python's standard library alone.

The definitions are those of `l4d score` (docs/scoring.md), whose counts.csv this program gives byte for byte and whose
numbers it gives: tests of the project compare both. It runs where no other program can be installed, executes nothing
that was submitted, unpacks nothing, and follows no link.

    python3 l4d_scorer.py REFERENCE SUBMISSION OUTPUT

REFERENCE and SUBMISSION are folders or zip files, OUTPUT receives scores.json and counts.csv.
Needs Python 3.7.
"""

import io
import json
import os
import struct
import sys
import zipfile
import zlib

# No sound submission has more. One that has is refused before more of it is read.
MAX_ENTRIES = 20000
MAX_CARD_BYTES = 1 << 20
MAX_TOTAL_BYTES = 64 << 20
# Of the list of files at the end of a zip.
MAX_LIST_BYTES = 8 << 20
# Folders below which nothing is looked for: masks stand in <folder>/masks/<scene>/.
DEEPEST = 3
# Digits of a number; more take Python long to read.
MAX_DIGITS = 20
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
        pending, entries = [""], 0
        while pending:
            inside = pending.pop()
            try:
                with os.scandir(os.path.join(root, inside)) as listed:
                    for entry in listed:
                        entries += 1
                        require_few(entries)
                        name = inside + entry.name
                        if entry.is_dir(follow_symlinks=False):
                            if name.count("/") < DEEPEST:
                                pending.append(name + "/")
                        elif entry.is_file(follow_symlinks=False):
                            self.sizes[name] = entry.stat(follow_symlinks=False).st_size
            except OSError as error:
                raise Refusal("%s cannot be listed: %s" % (shown(inside), shown(error.strerror)))

    def read(self, name, most):
        try:
            with open(os.path.join(self.root, *name.split("/")), "rb") as file:
                return bounded(file, most)
        except OSError as error:
            raise Refusal("cannot be read: %s" % shown(error.strerror))


class ZipFile(io.FileIO):
    """A zip on disk. `zipfile` reads the list of entries at once, before anybody can see how long it is."""

    is_listed = False

    def read(self, size=-1):
        if self.is_listed:
            return super().read(size)
        data = super().read(MAX_LIST_BYTES + 1 if size < 0 else min(size, MAX_LIST_BYTES + 1))
        if len(data) > MAX_LIST_BYTES:
            raise Refusal("the list of files in the archive is longer than %d bytes" % MAX_LIST_BYTES)
        return data


class Archive:
    """Files of a zip, by path; they are read one by one and never unpacked to a disk."""

    # What `zipfile` raises over bytes that are no zip.
    BROKEN = (zipfile.BadZipFile, zlib.error, struct.error, OSError, EOFError, RuntimeError, ValueError, IndexError, OverflowError)

    def __init__(self, path):
        try:
            file = ZipFile(path)
            self.archive = zipfile.ZipFile(file)
            file.is_listed = True
        except self.BROKEN as error:
            raise Refusal("the archive cannot be read: %s" % shown(error))
        entries = self.archive.infolist()
        require_few(len(entries))
        self.sizes = {}
        for entry in entries:
            if entry.filename in self.sizes:
                raise Refusal("%s stands in the archive twice" % shown(entry.filename))
            if not entry.filename.endswith("/"):
                self.sizes[entry.filename] = entry.file_size

    def read(self, name, most):
        if self.archive.getinfo(name).compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
            raise Refusal("cannot be read: it has to be stored or deflated")
        try:
            with self.archive.open(name) as file:
                return bounded(file, most)
        except self.BROKEN as error:
            raise Refusal("cannot be read: %s" % shown(error))


def require_few(entries):
    if entries > MAX_ENTRIES:
        raise Refusal("there are more than %d files and folders" % MAX_ENTRIES)


def bounded(file, most):
    # A header may lie about the size of what is packed.
    data = file.read(most + 1)
    if len(data) > most:
        raise Refusal("is larger than %d bytes" % most)
    return data


def open_files(path):
    return Folder(path) if os.path.isdir(path) else Archive(path)


def read_json(files, name, most):
    try:
        return parse(files.read(name, most))
    except Refusal as refusal:
        raise Refusal("%s: %s" % (name, refusal))


def parse(data):
    try:
        return json.loads(
            data.decode("utf-8"), parse_constant=refuse_constant, parse_int=short_number, object_pairs_hook=unique
        )
    except (ValueError, RecursionError) as error:
        raise Refusal("is no JSON: %s" % error)


def refuse_constant(name):
    raise ValueError("%s is no number" % name)


def short_number(digits):
    if len(digits) > MAX_DIGITS:
        raise ValueError("a number has more than %d digits" % MAX_DIGITS)
    return int(digits)


def unique(pairs):
    found = {}
    for key, value in pairs:
        if key in found:
            raise ValueError("%s stands there twice" % shown(key))
        found[key] = value
    return found


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
        if len(counts) > pixels + 1:
            raise ValueError("more runs than pixels")
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
        truth = read_json(files, "truth/%s.json" % name, MAX_TOTAL_BYTES)
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
        lines = files.read("queries/%s.jsonl" % name, MAX_TOTAL_BYTES).decode("utf-8").splitlines()
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
    """method.json and masks/<scene>/<nnn>.json, at the top or in one folder. What is wrong is added to `problems`."""

    def __init__(self, files, reference, problems):
        self.files = files
        self.problems = problems
        self.left = MAX_TOTAL_BYTES
        cards = [name for name in files.sizes if name == "method.json" or name.count("/") == 1 and name.endswith("/method.json")]
        if len(cards) != 1:
            raise Refusal("method.json has to stand once, at the top or in one folder; it stands there %d times" % len(cards))
        self.prefix = cards[0][: -len("method.json")]
        try:
            self.check_card(parse(files.read(cards[0], MAX_CARD_BYTES)), reference)
        except Refusal as refusal:
            problems.append("method.json: %s" % refusal)

    def check_card(self, card, reference):
        if not isinstance(card, dict):
            raise Refusal("is no object")
        expected = [
            ("profile", reference["profile"], "the profile here is"),
            ("truth_digest", reference["truth_digest"], "the truth here is"),
            ("benchmark_version", reference["version"], "the version here is"),
            ("protocol", "l4d", "it has to be"),
        ]
        for field, value, meaning in expected:
            if card.get(field) != value:
                self.problems.append("method.json: field `%s` is %s, but %s %s" % (field, shown(card.get(field)), meaning, value))
        used = card.get("used")
        if not isinstance(used, dict) or not isinstance(used.get("ground_truth"), bool) or not isinstance(used.get("test_view"), bool):
            self.problems.append("method.json: field `used` has to say whether ground_truth and test_view were used")
        else:
            self.check_used(used, reference)
        if card.get("baseline", False) is not False or card.get("name") in BASELINES:
            self.problems.append("method.json: baselines are not ranked; the names %s are theirs" % ", ".join(BASELINES))

    def check_used(self, used, reference):
        if used["ground_truth"]:
            self.problems.append("method.json: results that used the ground truth are not ranked")
        # Cards of before there was the field, and references of before there were tracks, are of the track colour.
        depth, track = used.get("depth", False), reference.get("track", "colour")
        if not isinstance(depth, bool):
            self.problems.append("method.json: `depth` in field `used` has to be true or false")
        elif depth and track == "colour":
            self.problems.append("method.json: what learned from rendered depth is ranked in another track; here it is colour")
        elif not depth and track != "colour":
            self.problems.append("method.json: what did not learn from rendered depth is ranked in the track colour; here it is colour + depth")

    def answers(self, scene, query):
        """Frame -> runs, or None for absent, one frame after another; what has no answer is not among them."""
        place = "masks/%s/%s.json" % (scene.name, query["id"].split("/")[1])
        if self.left < 0:
            return
        try:
            for frame, counts in self.frames(scene, place).items():
                try:
                    yield frame, None if counts is None else decode(counts, scene.pixels)
                except ValueError as error:
                    raise Refusal("frame %04d: %s" % (frame, error))
        except Refusal as refusal:
            self.problems.append("%s: %s" % (place, refusal))

    def frames(self, scene, place):
        """Frame -> run lengths as they were sent."""
        if self.prefix + place not in self.files.sizes:
            raise Refusal("is missing")
        # Run lengths of pure noise take one character a pixel, and all else takes less.
        data = self.files.read(self.prefix + place, len(scene.clip) * (scene.pixels + 16) + (64 << 10))
        self.left -= len(data)
        if self.left < 0:
            raise Refusal("with it all masks are larger than %d bytes; nothing more was read" % MAX_TOTAL_BYTES)
        document = parse(data)
        if not isinstance(document, dict) or set(document) != {"size", "frames"}:
            raise Refusal("has to hold `size` and `frames`, nothing else")
        if document["size"] != scene.size or not isinstance(document["frames"], dict):
            raise Refusal("`size` is %s, but the truth has %s" % (shown(document["size"]), scene.size))
        frames = {}
        for key, counts in document["frames"].items():
            if len(key) != 4 or not key.isdigit() or not key.isascii() or int(key) not in scene.clip:
                raise Refusal("%s is no frame of the clip" % shown(key))
            if counts is not None and not isinstance(counts, str):
                raise Refusal("frame %s is neither run lengths nor null" % key)
            frames[int(key)] = counts
        missing = [frame for frame in scene.frames if frame not in frames]
        if missing:
            raise Refusal("%d frames have no answer, the first is %04d" % (len(missing), missing[0]))
        return frames


# ---- counts and ratios -----------------------------------------------------------------------------------------


def count(scene, query, frame, answer):
    """A row of counts.csv: state, intersection, union, predicted, truth, instance, instance_overlap."""
    if frame not in scene.frames:
        return ("not_annotated", 0, 0, 0, 0, "", 0)
    target = scene.target(query, frame)
    predicted = answer or []
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
    reference = read_json(files, "reference.json", MAX_CARD_BYTES)
    problems, rows, scored = [], [HEADER], []
    submission = Submission(open_files(submission_path), reference, problems)
    for name in reference["scenes"]:
        scene = Scene(files, name)
        for query in scene.queries:
            counted = {frame: count(scene, query, frame, answer) for frame, answer in submission.answers(scene, query)}
            for frame in scene.clip:
                if frame not in counted:
                    counted[frame] = count(scene, query, frame, None)
            number = query["id"].split("/")[1]
            for frame in scene.clip:
                rows.append("%s,%s,%d,%s" % (name, number, frame, ",".join(map(str, counted[frame]))))
            scored.append((query, scene, ratios(query, [counted[frame] for frame in scene.clip])))
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
