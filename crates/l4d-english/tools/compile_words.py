"""Compiles `src/wide/nouns.txt` and `src/wide/common.txt` from WordNet 3.0.

Usage: python3 tools/compile_words.py [/usr/share/wordnet]   (Debian package `wordnet-base`)

nouns.txt   a line each: a word that people say, then the categories of scenes that it may mean, with how far it is from
            them: 1 another name, 2 a kind of it ("mallard" of duck), 3 and more: something that it is a kind of
            ("vehicle" of car).
common.txt  frequent English words, which are therefore no misspellings of other words.

WordNet 3.0 Copyright 2006 by Princeton University. All rights reserved. Its licence permits use, copying and
distribution for any purpose without fee, with this notice.
"""

import re
import sys
import tomllib
from collections import defaultdict
from pathlib import Path

CRATE = Path(__file__).resolve().parent.parent
# Lexicographer files: animal, artifact, body, food, object, person, plant, substance, group.
KINDS = {"05", "06", "08", "13", "17", "18", "20", "27", "14"}
# Which sense is meant where the first of a fitting kind is not; a word and the number of the sense, or none.
SENSES = {
    "bananas": ("banana", 2), "books": None, "chairs": None, "mats": None, "magazines": None, "plates": None,
    "notes": None, "parts": None, "crayons": ("crayon", 1), "grapes": ("grape", 1), "lily_pads": ("water_lily", 1),
    "bale": None, "ball": ("ball", 1), "block": ("block", 1), "board": ("chopping_board", 1), "bin": ("ashcan", 1),
    "chest": ("chest", 2), "churn": ("churn", 1), "coat_stand": ("coatrack", 1), "desk_pad": None,
    "cat_tree": None, "cook": ("cook", 1), "crossing": ("crossing", 4), "cup": ("cup", 1), "cupboard": ("wardrobe", 1),
    "dish": ("dish", 1), "dock": None, "dumbbell": ("dumbbell", 1), "eraser": ("eraser", 1),
    "glasses": ("spectacles", 1), "globe": ("globe", 3), "goal": ("goal", 4), "ground": ("floor", 1),
    "headphones": ("earphone", 1), "hob": ("stove", 1), "island": None, "kerb": ("curb", 1), "lamp": ("lamp", 2),
    "lamp_post": ("lamppost", 1), "leaves": ("leaf", 1), "loaf": ("loaf_of_bread", 1), "machine": ("machine", 1),
    "magazine": ("magazine", 1), "marker": ("highlighter", 2), "mat": ("mat", 1), "mooring_post": ("bollard", 1), "bollard": None,
    "mouse": ("mouse", 4), "mouse_mat": ("mousepad", 1), "oil_can": None, "paper": None, "pen_pot": None,
    "person": None, "pail": ("bucket", 1), "picture": ("picture", 1), "picture_book": ("picture_book", 1),
    "pipes": ("pipe", 2), "plant": ("houseplant", 1), "planter": None, "plate": ("plate", 4),
    "post": ("post", 4), "punching_bag": None, "rack": ("rack", 1), "rail": ("railing", 1),
    "reeds": ("reed", 1), "room": None, "sandbox": ("sandbox", 1), "shelf": ("shelf", 1), "shop": ("shop", 1),
    "sign": ("signboard", 1), "sink": ("sink", 1), "sitter": None, "slab": ("slab", 1), "slide": ("slide", 4), "soup": ("soup", 1),
    "spade": ("spade", 1), "stall": ("stall", 3), "stand": None, "step": ("step", 4), "stones": ("rock", 1),
    "straw": None, "swing": ("swing", 2), "table": ("table", 2), "terminal": ("terminal", 1), "tin": ("can", 1),
    "tool_board": None, "top": ("top", 8), "toy": ("toy", 1), "trolley": ("handcart", 1), "wall_bars": None,
    "wood": None, "word": None, "worktop": ("counter", 1), "washer": ("washer", 3), "bus_stop": ("bus_stop", 1),
    "athlete": ("athlete", 1), "pedestrian": ("pedestrian", 1), "tower": None, "water": ("water", 1),
    "paving": ("pavement", 1), "garden": ("garden", 1), "house": ("house", 1), "wall": ("wall", 1), "well": ("well", 1),
    "window": ("window", 1), "door": ("door", 1), "woman": ("woman", 1), "man": ("man", 1), "child": ("child", 1),
    "hand": ("hand", 1), "orange": ("orange", 1), "pear": ("pear", 1), "lemon": ("lemon", 1), "apple": ("apple", 1),
    "bird": ("bird", 1), "pot": ("pot", 1), "phone": ("telephone", 1), "lockers": ("locker", 2), "cabinet": ("cabinet", 1),
    "blackboard": ("blackboard", 1), "rope": ("rope", 1), "robot": ("automaton", 2), "notebook": ("notebook", 1),
    "teddy": ("teddy", 1), "monitor": ("monitor", 4), "keyboard": ("keyboard", 1), "hen": ("hen", 1), "duck": ("duck", 1),
    "crock": None, "cushion": ("cushion", 3), "pen": ("pen", 1), "bus_stop": None,
    "cake": ("cake", 3), "clock": ("clock", 1), "gate": ("gate", 1), "ramp": ("ramp", 1), "poster": ("poster", 1),
    "easel": ("easel", 1), "toy_car": None, "box": ("box", 1), "bag": ("bag", 4), "car": ("car", 1),
}
# What is too general to be said of a thing in a scene, or means something else to most people.
TOO_GENERAL = set(
    "entity physical_entity object physical_object whole unit artifact artefact instrumentality instrumentation "
    "causal_agent cause causal_agency matter substance living_thing animate_thing organism being natural_object "
    "way passage passageway area commodity covering module system location region part portion piece relation "
    "abstraction group grouping collection attribute measure body life soul mortal somebody someone individual device "
    "solid food nutrient foodstuff produce structure construction plant_organ plant_part vascular_plant tracheophyte "
    "craft conveyance transport representation creation mechanism sheet implement means support supporting_structure "
    "publication work product production material stuff barrier obstruction surface line opening".split()
)
NOT_MEANT = set(
    "pet queen tom bitch beast girl boy bird hand hat top head set it one back red bunch left right first last end start pair paw leg arm "
    "side other stroke turn watch hold point poke light dark black white blue orange kick run walk lift wave roll push drink open close "
    "nearest front still tall wide cover body place way line time spot half round band dial letter moon star gear gears pot hot can go "
    "stand mark must might be who in as at am are do does no so or on i a b c d e ii he she they you down up out over off by coat fur apron shirt dress "
    "skirt trousers collar sleeve roof ear ears tail nose beak bill chest hair bun stripe check dot patch tie face mouth eye world best rest "
    "jack doll tool gun horn knocker boob bomb strap belt ring pack case bow wing peg stick key saw pick mate match board game park bell court club".split()
)
DEEPEST_KIND, HIGHEST = 5, 4


def main() -> None:
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "/usr/share/wordnet")
    synsets = dict(read_synsets(folder / "data.noun"))
    senses = dict(read_senses(folder / "index.noun"))
    below = defaultdict(list)
    for offset, (_, _, above) in synsets.items():
        for parent in above:
            below[parent].append(offset)
    lexicon = tomllib.loads((CRATE / "src/lexicon.toml").read_text())
    meaning: dict[str, dict[str, int]] = defaultdict(dict)

    def add(word: str, category: str, distance: int) -> None:
        if word in TOO_GENERAL or word in NOT_MEANT or not re.fullmatch(r"[a-z][a-z_'-]*", word):
            return
        meaning[word][category] = min(distance, meaning[word].get(category, 99))

    def rank_of(word: str, offset: str) -> int:
        found = senses.get(word, [])
        return found.index(offset) if offset in found else 99

    for category in lexicon["nouns"]:
        chosen = SENSES.get(category, (category, 0))
        if chosen is None:
            continue
        word, number = chosen
        options = senses.get(word, [])
        if number:
            options = options[number - 1 : number]
        entry = lexicon["nouns"][category]
        kinds = ["18"] if "person" in entry else ["05"] if entry.get("animal") else ["06", "13", "20", "27", "08", "17"]
        if number:
            kinds = sorted(KINDS)
        fitting = [offset for kind in kinds for offset in options if synsets[offset][0] == kind]
        root = fitting[0] if fitting else None
        if root is None:
            print(f"no sense: {category}", file=sys.stderr)
            continue
        if "--senses" in sys.argv:
            print(category, synsets[root][1], root)
        for lemma in synsets[root][1]:
            if rank_of(lemma, root) <= 3:
                add(lemma, category, 1)
        # Kinds of people are no matter of pictures; kinds of hands are no hands.
        has_kinds = "person" not in entry and category not in ("hand", "water", "soup", "grass")
        level = [root] if has_kinds else []
        for _ in range(DEEPEST_KIND):
            level = [child for offset in level for child in below[offset]]
            for offset in level:
                for lemma in synsets[offset][1]:
                    # A kind by its usual name: the first sense of the word, or one of several words.
                    if lemma.endswith(("_" + category, "_" + word)):
                        continue
                    if rank_of(lemma, offset) == 0 and ("_" not in lemma or synsets[offset][1][0] == lemma):
                        add(lemma, category, 2)
        level, distance = [root], 2
        while level and distance < 2 + HIGHEST:
            level = [parent for offset in level for parent in synsets[offset][2]]
            distance += 1
            for offset in level:
                for lemma in synsets[offset][1]:
                    if rank_of(lemma, offset) <= 1:
                        add(lemma, category, distance)
    own = {name.replace("_", " ") for name in lexicon["nouns"]}
    lines = []
    for word, categories in sorted(meaning.items()):
        if len(word) > 24 or word.count("_") > 1:
            continue
        if set(categories) <= {"tree", "bush", "bird", "plant", "reeds", "dog", "stones", "leaves"} and "_" in word:
            continue
        ordered = sorted(categories.items(), key=lambda pair: (pair[1], pair[0]))
        if ordered[0][1] <= 2:
            ordered = [pair for pair in ordered if pair[1] <= 2]
        spelled = word.replace("_", " ")
        if spelled in own:
            ordered = [pair for pair in ordered if pair[0].replace("_", " ") != spelled]
        if ordered:
            lines.append(f"{spelled}\t" + " ".join(f"{category}:{distance}" for category, distance in ordered))
    (CRATE / "src/wide/nouns.txt").write_text("\n".join(lines) + "\n")
    (CRATE / "src/wide/common.txt").write_text("\n".join(common(folder)) + "\n")


def read_synsets(path: Path):
    for line in path.open():
        if line.startswith("  "):
            continue
        fields = line.split(" | ")[0].split()
        count = int(fields[3], 16)
        words = [fields[4 + 2 * at].lower() for at in range(count)]
        pointers = fields[5 + 2 * count :]
        above = [pointers[at + 1] for at in range(0, len(pointers) - 3, 4) if pointers[at] in ("@", "@i")]
        yield fields[0], (fields[1], words, above)


def read_senses(path: Path):
    for line in path.open():
        if line.startswith("  "):
            continue
        fields = line.split()
        count = int(fields[2])
        yield fields[0], fields[-count:]


def common(folder: Path) -> list[str]:
    counts: dict[str, int] = defaultdict(int)
    for line in (folder / "cntlist.rev").open():
        key, _, count = line.split()
        word = key.split("%")[0]
        if re.fullmatch(r"[a-z]{3,}", word):
            counts[word] += int(count)
    return sorted(word for word, count in counts.items() if count >= 8)


main()
