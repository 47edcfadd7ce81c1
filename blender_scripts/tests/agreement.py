"""Declared events against measured tracks, as `l4d check-queries` compares them (L4D220 to L4D223)."""

from __future__ import annotations

import numpy as np

HOLDING = set("hold carry pull push move drag grip hug ride wear curl".split())
MEETING = set("lift put_down take bat kick touch pet catch drink turn nudge throw drink_from open".split())
MOVING = set("walk run roll slide drive swim fly trot chase swing circle land pull_out brake".split())
RESTING = set("stand sit sleep lie rest wait crouch".split())
QUIET = RESTING | set("watch look_at face hold phone".split())
SPEED_MPS = {"outdoor": 0.15, "room": 0.10, "tabletop": 0.02}
STAYS_M = {"outdoor": 0.35, "room": 0.30, "tabletop": 0.05}
HOLD_M, STIRS_M = 0.02, 0.001


def disagreements(tracks: dict) -> list[str]:
    """One line per event that the measured boxes and distances contradict."""
    boxes = {}
    for instance in tracks["instances"]:
        track = instance["track"]
        rows = [np.array(track[key], float) for key in ("centre", "axes", "extents")]
        boxes[instance["name"]] = [np.repeat(row, 97, axis=0) if len(row) == 1 else row for row in rows]
    distances = {frozenset((pair["a"], pair["b"])): pair["distance_m"] for pair in tracks["pairs"]}
    found = []
    for event in tracks["events"]:
        subject, verb, (first, last) = event["subject"], event["verb"], event["frames"]
        what = f"{subject} {verb} {event['object'] or ''} {first}..{last}"
        centre = boxes[subject][0][first : last + 1]
        if event["object"] and verb in MEETING | HOLDING:
            row = distances.get(frozenset((subject, event["object"])), [np.inf])
            gaps = np.array(row if len(row) > 1 else row * 97)[first : last + 1]
            worst = gaps[3:-3].max() if verb in HOLDING else gaps.min()
            if worst > HOLD_M:
                found.append(f"{what}: {100 * worst:.1f} cm apart")
        if verb in MOVING:
            way = np.linalg.norm(np.diff(centre, axis=0), axis=1).sum()
            if way / (len(centre) / 24.0) < SPEED_MPS[tracks["scale"]]:
                found.append(f"{what}: moves {way:.2f} m only")
        if verb in RESTING:
            strays = np.linalg.norm(centre[:, :2] - centre[:, :2].mean(axis=0), axis=1).max()
            if strays > STAYS_M[tracks["scale"]]:
                found.append(f"{what}: strays {strays:.2f} m")
        if verb not in QUIET:
            names = [subject, *([event["object"]] if event["object"] else [])]
            stirs = any(
                np.abs(part[first : last + 1] - part[first]).max() > STIRS_M
                for n in names
                for part in boxes[n]
            )
            if not stirs:
                found.append(f"{what}: nothing moves")
    return found
