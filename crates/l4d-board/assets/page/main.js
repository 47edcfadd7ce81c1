// Puts the view that the address asks for onto the page.

function draw(isFirst) {
  const state = readAddress();
  const main = document.getElementById("main");
  const protocol = protocolOf(state);
  const method = board.methods[methodIndex(state.method)];
  const judged = protocol?.methods.find((other) => other.name === state.method);
  const scene = board.scenes[sceneIndex(state.scene)];
  const query = scene?.queries.find((query) => query.number === state.query);
  const view = state.method === "" ? "board" : state.scene === "" ? "method" : state.query === "" ? "scene" : "query";
  const isThere = {
    board: true,
    method: protocol ? judged : method?.isDetailed,
    scene: (protocol ? judged : method)?.isDetailed && scene,
    query: method?.isDetailed && query,
  }[view];
  main.replaceChildren();
  let drawn;
  if (!isThere) drawn = drawLost(main);
  else if (view === "board") drawn = drawBoard(main);
  else if (view === "method" && protocol) drawn = drawProtocolMethod(main, protocol, judged);
  else if (view === "scene" && protocol) drawn = drawProtocolScene(main, protocol, judged, scene);
  else if (view === "method") drawn = drawMethod(main, method);
  else if (view === "scene") drawn = drawScene(main, method, scene);
  else drawn = drawQuery(main, method, scene, query);
  const heading = main.querySelector("h1");
  document.title = `${heading.textContent} \u2013 ${board.benchmark} leaderboard`;
  if (!isFirst) {
    scrollTo(0, 0);
    heading.focus();
  }
  return Promise.resolve(drawn).catch((error) => {
    main.append(el("p", { class: "notice" }, "This part of the page could not be unpacked. A current browser is needed (DecompressionStream)."));
    throw error;
  });
}

function drawLost(main) {
  main.append(
    el("h1", { tabindex: -1 }, "There is nothing at this address"),
    el("p", {}, "The page holds no such method, scene or query, or not what that method did. ", el("a", { href: "#" }, "Back to the leaderboard")),
  );
}

function drawFrame() {
  document.getElementById("brand").append(el("a", { href: "#" }, board.benchmark), el("span", {}, "leaderboard"));
  document.getElementById("foot").append(
    el("p", {}, `${board.line}. Truth `, el("code", {}, board.truthDigest.slice(0, 12)), board.day ? `. Date ${board.day}.` : "."),
    el("p", {}, "Every number follows from ", el("code", {}, "scores/<method>/counts.csv"), "; masks and pictures are for the eye. Made by ", el("code", {}, "l4d leaderboard --html"), `, l4d ${board.software}.`),
  );
  // The skip link must not become the address of a view.
  document.getElementById("skip").addEventListener("click", (event) => {
    event.preventDefault();
    document.getElementById("main").focus();
  });
}

/** Escape leads one step up the trail, except where it means something already. */
function goUp(event) {
  if (event.key !== "Escape" || event.defaultPrevented || event.target.closest("select, input[type=search]")) return;
  const up = document.querySelector(".trail li:nth-last-child(2) a");
  if (up) location.hash = up.hash;
}

function followTheme() {
  const select = document.getElementById("theme");
  const apply = (theme) => {
    document.documentElement.style.colorScheme = theme === "" ? "light dark" : theme;
  };
  // A browser may forbid storage to files; the choice then lasts as long as the page.
  const remembered = (() => {
    try {
      return localStorage.getItem("l4d-theme") ?? "";
    } catch {
      return "";
    }
  })();
  select.value = ["light", "dark"].includes(remembered) ? remembered : "";
  apply(select.value);
  select.addEventListener("change", () => {
    apply(select.value);
    try {
      localStorage.setItem("l4d-theme", select.value);
    } catch {
      // As above.
    }
  });
}

followTheme();
drawFrame();
draw(true);
addEventListener("hashchange", () => draw(false));
addEventListener("keydown", goUp);
performance.mark("interactive");
