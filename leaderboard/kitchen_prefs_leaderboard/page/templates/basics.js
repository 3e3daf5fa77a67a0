"use strict";

const data = JSON.parse(document.getElementById("data").textContent);
const SPLITS = Object.keys(data.splits);
const TRACKS = {
  standard: "Trained on train alone; the prompt is one demonstration.",
  privileged: "The policy reads the preference's label.",
  language: "The policy reads the preference in words.",
  open: "Anything may be used, the simulator in training included.",
};
const SVG = "http://www.w3.org/2000/svg";

const byId = (id) => document.getElementById(id);
const words = (name) => name.replaceAll("_", " ");
/** A number with a real minus sign, and none before a zero. */
const fixed = (value, digits = 3) =>
  value.toFixed(digits).replace(/^-(?=[0.]*$)/, "").replace("-", "\u2212");
const short = (value) => fixed(value).replace(/^(\u2212?)0\./, "$1."); // in narrow columns

/** Give an element attributes and children. No string is ever parsed as HTML. */
function fill(element, attributes, children) {
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === "function") element.addEventListener(name, value);
    else if (value !== null && value !== false) element.setAttribute(name, value);
  }
  element.append(...children.filter((child) => child !== null));
  return element;
}

/** An HTML element. */
function html(tag, attributes = {}, ...children) {
  return fill(document.createElement(tag), attributes, children);
}

/** An SVG element. */
function svg(tag, attributes = {}, ...children) {
  return fill(document.createElementNS(SVG, tag), attributes, children);
}

/** A link out of the page; anything but a web address is shown as text. */
function linkTo(address) {
  if (!/^https?:\/\//.test(address)) return html("span", {}, address);
  return html("a", { href: address, rel: "noopener noreferrer nofollow" }, address);
}

/** Fill a select with [value, text] pairs; keep the chosen one if it is still among them. */
function setOptions(select, pairs) {
  const chosen = select.value;
  select.replaceChildren(...pairs.map(([value, text]) => html("option", { value }, text)));
  if (pairs.some(([value]) => String(value) === chosen)) select.value = chosen;
}

/** The entries as choices, each with its track, as names may repeat. */
function entryChoices() {
  return data.entries.map(({ submission }, i) => [i, `${submission.name} (${submission.track})`]);
}
