// ---- Dialogs ----

let whenSure = null;

function askWhether(title, text, yes, does) {
  $("sure-title").textContent = title;
  $("sure-text").textContent = text;
  $("yes").textContent = yes;
  whenSure = does;
  $("sure").showModal();
  // A stray Enter must not seal.
  $("no").focus();
}

function confirm() {
  const does = whenSure;
  whenSure = null;
  $("sure").close();
  does?.();
}

function closeDialogs() {
  for (const dialog of document.querySelectorAll("dialog")) dialog.close();
}
