// Asking a sentence of one's own, where the page comes from `l4d serve`.

/** Milliseconds between questions how far an answer is. */
const PATIENCE = 200;

/** What the server says; a refusal is an error with what can be done about it. */
async function said(response) {
  const document = await response.json();
  if (!response.ok) throw new Error(`${document.message}; ${document.hint}`);
  return document;
}

async function answerTo(text) {
  const headers = { "Content-Type": "application/json" };
  const { id } = await said(await fetch("/questions", { method: "POST", headers, body: JSON.stringify({ text }) }));
  for (;;) {
    const now = await said(await fetch(`/questions/${id}`));
    if (now.state === "answered") return { id, ...now.answer };
    if (now.state === "failed") throw new Error(`${now.message}; ${now.hint}`);
    showStage(now);
    await new Promise((resolve) => setTimeout(resolve, PATIENCE));
  }
}

function showStage({ state, ahead, stage, done, total }) {
  const bar = $("stages");
  bar.hidden = false;
  if (total) Object.assign(bar, { max: total, value: done });
  else bar.removeAttribute("value");
  $("answer").textContent = state === "waiting" ? `waits for ${ahead + 1} before it` : stage;
}

/** The answer joins the sentences, as one of the last method, and is looked at. */
function showAnswer(text, { id, message, read, camera, size, masks }) {
  $("answer").replaceChildren(message.split("; picture: ")[0]);
  for (const line of read) $("answer").append(element("br"), line);
  if (!masks) return;
  DOCUMENT.masks ??= [camera, size];
  const own = DOCUMENT.methods.length - 1;
  const sentence = { number: `yours ${id}`, text, categories: ["yours"], temporal: "whole", referents: [], frames: [] };
  DOCUMENT.sentences.push({ ...sentence, truth: null, answers: DOCUMENT.methods.map((_, k) => (k === own ? masks : null)) });
  $("asked").hidden = false;
  $("sentences").prepend(sentenceButton(DOCUMENT.sentences.at(-1)));
  choose(sentence.number);
  state.masks = true;
}

async function askSentence(event) {
  event.preventDefault();
  const text = $("sentence").value.trim();
  if (!text) return;
  const button = $("ask").querySelector("button");
  button.disabled = true;
  showStage({ stage: "asking" });
  try {
    showAnswer(text, await answerTo(text));
  } catch (error) {
    $("answer").textContent = error instanceof TypeError ? "the server is gone; start l4d serve again" : error.message;
  }
  $("stages").hidden = true;
  button.disabled = false;
}

if (DOCUMENT.asks) {
  $("question").hidden = false;
  $("ask").addEventListener("submit", askSentence);
}
