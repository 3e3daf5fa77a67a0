"use strict";

const data = JSON.parse(document.getElementById("data").textContent);
const SVG = "http://www.w3.org/2000/svg";

const byId = (id) => document.getElementById(id);
const words = (name) => name.replaceAll("_", " ");
/** A number with a real minus sign, and none before a zero. */
const fixed = (value, digits = 3) =>
  value.toFixed(digits).replace(/^-(?=[0.]*$)/, "").replace("-", "\u2212");
const short = (value) => fixed(value).replace(/^(\u2212?)0\./, "$1."); // in narrow columns

/** Bytes that JSON holds in base64. */
function bytesOf(base64) {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i += 1) bytes[i] = text.charCodeAt(i);
  return bytes;
}

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

/** A text in a drawing. */
const label = (x, y, text, name = "") => svg("text", { x, y, class: name }, text);

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

/** The button that changes between the light and the dark theme; at first the system's applies. */
function startTheme(button) {
  const root = document.documentElement;
  const system = matchMedia("(prefers-color-scheme: dark)");
  const dark = () => (root.dataset.theme ? root.dataset.theme === "dark" : system.matches);
  const showLabel = () => { button.textContent = dark() ? "Light" : "Dark"; };
  button.addEventListener("click", () => {
    root.dataset.theme = dark() ? "light" : "dark";
    showLabel();
  });
  showLabel();
}
