/** One cell: in how many episodes of a split it happened; it opens them in the player. */
function reasonCell(index, split, reason) {
  const times = data.entries[index].shortcomings[split][reason];
  if (times === 0) return html("td", { class: "number none" }, "0");
  const share = Math.round((100 * times) / data.splits[split]);
  const click = () => openEpisodes(index, split, `reason:${reason}`);
  const title = `${times} episodes of ${words(split)}: ${data.reasons[reason]}`;
  const open = html("button", { type: "button", click, "aria-label": title }, String(times));
  const small = html("small", {}, share ? `${share} %` : "< 1 %");
  const cell = html("td", { class: "number tinted" }, open, small);
  cell.style.setProperty("--share", `${0.4 * share}%`); // the text stays readable on it
  return cell;
}

function drawReasons() {
  const index = Number(byId("reasons-entry").value);
  const heads = SPLITS.map((split) => html("th", { scope: "col", class: "number" }, words(split),
    html("small", {}, `of ${data.splits[split]}`)));
  const rows = data.reasons.map((name, reason) => html("tr", {}, html("th", { scope: "row" }, name),
    ...SPLITS.map((split) => reasonCell(index, split, reason))));
  const title = `Failure modes of ${nameOf(index)}`;
  byId("reasons-table").replaceChildren(html("table", { class: "reasons" },
    html("caption", { class: "unseen" }, title),
    html("thead", {}, html("tr", {}, html("th", { scope: "col" }, "Episodes"), ...heads)),
    html("tbody", {}, ...rows)));
}

function startReasons() {
  setOptions(byId("reasons-entry"), entryChoices());
  byId("reasons-entry").addEventListener("change", drawReasons);
  drawReasons();
}
