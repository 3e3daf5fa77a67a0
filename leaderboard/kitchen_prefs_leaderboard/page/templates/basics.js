"use strict";

const data = JSON.parse(document.getElementById("data").textContent);
const SPLITS = Object.keys(data.splits);
const TRACKS = {
  standard: "Instances and one demonstration as the prompt.",
  privileged: "The policy is told the preference itself.",
  language: "The preference comes as a sentence.",
  open: "Anything goes.",
};
const SVG = "http://www.w3.org/2000/svg";

const byId = (id) => document.getElementById(id);
const words = (name) => name.replaceAll("_", " ");
const fixed = (value, digits = 3) => value.toFixed(digits).replace("-", "\u2212");

/** Give an element attributes and children. Text stays text: no string is ever read as HTML. */
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

/** A link out of the page; what is no web address stays text. */
function linkTo(address) {
  if (!/^https?:\/\//.test(address)) return html("span", {}, address);
  return html("a", { href: address, rel: "noopener noreferrer nofollow" }, address);
}

/** Fill a select with [value, text] pairs; keep what is chosen if it is still there. */
function setOptions(select, pairs) {
  const chosen = select.value;
  select.replaceChildren(...pairs.map(([value, text]) => html("option", { value }, text)));
  if (pairs.some(([value]) => String(value) === chosen)) select.value = chosen;
}

/** The entries as choices, each with its track: names need not differ. */
function entryChoices() {
  return data.entries.map(({ submission }, i) => [i, `${submission.name} (${submission.track})`]);
}
