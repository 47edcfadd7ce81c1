// ---- Begin ----

/** For tests: what the page knows, and keys. In a text field, anything that is no key is typed. */
window.vote = {
  press(key) {
    if (isTyping() && key !== "Enter" && key !== "Escape") $("remark").value += key;
    else {
      const does = meaningOf(key, false);
      if (does) act(does);
    }
    return window.vote.state();
  },
  state() {
    const { choice } = model.draft;
    return {
      at: model.at, item: item().item, mode: $("sure").open ? "sure" : $("keys").open ? "keys" : model.mode,
      answered: places((response) => response.answer !== null).length,
      skipped: places((response) => response.skipped).length,
      sealed: model.ballot.isSealed, chosen: structuredClone(choice.objects ?? choice), frames: [...holds()],
      view: scene().views[model.view], frame: frameNumber(), message: model.notice?.text ?? "",
    };
  },
  ballot: () => model.ballot.text,
  /** Goes on from the text of a copy, as if its file had been chosen. */
  resume(text) {
    act(() => resumeFrom(text));
    return window.vote.state();
  },
};

paint();
recallBallot();
begin();
show();
new ResizeObserver(askForDrawing).observe($("frame"));
performance.mark("interactive");
