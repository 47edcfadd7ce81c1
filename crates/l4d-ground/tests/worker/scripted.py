"""A worker that misbehaves as it is told: `python3 scripted.py MODE [FILE]`. Stands apart from l4d_workers on purpose."""

import json
import os
import signal
import subprocess
import sys
import time

MODE = sys.argv[1]
FILE = sys.argv[2] if len(sys.argv) > 2 else None


def say(line):
    sys.stdout.write(json.dumps(line) + "\n")
    sys.stdout.flush()


def starts():
    """How often this worker was started, counted in a file."""
    with open(FILE, "a") as file:
        file.write("x")
    return os.path.getsize(FILE)


def box(order, frame, columns, obj=1, **more):
    """A mask of the whole columns first..last."""
    width, height = order["frames"]["width"], order["frames"]["height"]
    first, last = columns
    runs = [first * height, (last - first) * height, (width - last) * height]
    line = {"id": order["id"], "frame": frame, "obj": obj}
    line["rle"] = {"size": [height, width], "counts": counts(runs)}
    return {**line, **more}


def counts(runs):
    """COCO's text of up to three runs."""
    text = ""
    for run in runs:
        while True:
            group, run = run & 0x1F, run >> 5
            is_last = run == 0 and not group & 0x10
            text += chr(48 + group + (0 if is_last else 32))
            if is_last:
                break
    return text


def hello(**more):
    line = {"protocol": 1, "name": "scripted", "version": "1", "prompts": ["box", "text"], "text": "phrase"}
    say({"hello": {**line, **more}})


def answer(order):
    """Columns 0 to 4 in all frames."""
    for frame in range(order["range"][0], order["range"][1] + 1):
        say(box(order, frame, (0, 4)))
    say({"id": order["id"], "done": True})


def orders():
    for line in sys.stdin:
        order = json.loads(line)
        if order["op"] == "shutdown":
            return
        yield order


if MODE == "old":
    hello(protocol=7)
elif MODE == "mute":
    time.sleep(600)
elif MODE == "chatty":
    print("Loading weights: 100%")
elif MODE == "early-death":
    sys.stderr.write("no such model\n")
    sys.exit(3)
elif MODE == "grandchild":
    child = subprocess.Popen(["sleep", "600"])
    with open(FILE, "w") as file:
        file.write(str(child.pid))
    hello()
    # It neither reads nor leaves.
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    time.sleep(600)
else:
    count = starts() if FILE else 1
    hello(version=str(count) if MODE == "changes" else "1")

for order in orders():
    if order["op"] == "cancel":
        if FILE:
            open(FILE + ".cancelled", "w").close()
        continue
    number = order["id"]
    text = order["prompts"][0].get("text")
    if MODE in ("dies-once", "changes") and count == 1:
        sys.stderr.write("out of luck\n")
        os.kill(os.getpid(), signal.SIGKILL)
    elif MODE == "dies":
        sys.exit(7)
    elif MODE == "hangs":
        say(box(order, 0, (0, 4)))
        time.sleep(600)
    elif MODE == "busy":
        while True:
            say({"alive": True})
            time.sleep(0.02)
    elif MODE == "wrong-size" and text == "bad":
        say({"id": number, "frame": 0, "obj": 1, "rle": {"size": [4, 4], "counts": "@0"}})
        say({"id": number, "done": True})
    elif MODE == "torn-mask" and text == "bad":
        say({"id": number, "frame": 0, "obj": 1, "rle": {"size": [6, 8], "counts": "99"}})
    elif MODE == "wrong-frame" and text == "bad":
        say(box({**order}, 7, (0, 1)))
    elif MODE == "twice" and text == "bad":
        say(box(order, 0, (0, 1)))
        say(box(order, 0, (0, 2)))
    elif MODE == "crowd" and text == "bad":
        for obj in range(1000):
            say(box(order, 0, (0, 1), obj=obj))
        say({"id": number, "done": True})
    elif MODE == "wrong-id":
        say({"id": number + 1000, "done": True})
    elif MODE == "garbage":
        print("{'id': 1, 'done': True}", flush=True)
    elif MODE == "flood":
        while True:
            sys.stdout.write("x" * 65536)
    elif MODE == "talks":
        sys.stderr.write("\x1b[31mtalk \xe4\n" * 100000)
        answer(order)
    elif MODE == "late":
        say(box(order, 0, (0, 4)))
        if number > 1:
            # More about a request that was given up.
            say(box({**order, "id": number - 1}, 1, (0, 4)))
            say({"id": number - 1, "done": True})
        if text == "bad":
            say(box({**order}, 7, (0, 1)))
        else:
            say({"id": number, "done": True})
    elif text == "refuse":
        say({"id": number, "error": {"kind": "bad_text", "msg": "too long\u001b[0m"}})
    elif text == "memory":
        say({"id": number, "error": {"kind": "oom", "msg": "no memory"}})
    elif text == "things":
        # Three objects: two that are seen, and one that never is.
        for frame in range(order["range"][0], order["range"][1] + 1):
            say(box(order, frame, (0, 4), obj=11, score=0.9))
            say(box(order, frame, (10, 20), obj=12, score=0.5))
            say(box(order, frame, (5, 5), obj=13, score=0.7))
        say({"id": number, "done": True, "skipped": ["hole filling"]})
    elif text == "nothing":
        say({"id": number, "done": True})
    else:
        answer(order)
