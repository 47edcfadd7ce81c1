"""What EvalAI calls: one function, which scores a zip of masks."""

from .l4d_scorer import score

# Titles of the leaderboard -> columns of the scorer; challenge_config.yaml lists the same titles.
LABELS = {
    "mIoU": "miou",
    "tube IoU": "tube_iou",
    "select": "select",
    "mAcc": "macc",
    "Acc@0.25": "acc25",
    "Acc@0.5": "acc50",
    "false positives": "fpr",
    "attribute": "miou_attribute",
    "action": "miou_action",
    "spatial": "miou_spatial",
    "interaction": "miou_interaction",
}


def evaluate(test_annotation_file, user_submission_file, phase_codename, **kwargs):
    """Scores a submission; a Refusal, raised, is shown to the one who submitted."""
    scores, _ = score(test_annotation_file, user_submission_file)
    shown = {label: scores[column] for label, column in LABELS.items()}
    return {"result": [{"test": shown}], "submission_result": scores}
