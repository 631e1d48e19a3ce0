// Elements of the page. Text goes in as text, never as markup.

function el(tag, properties = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else if (name === "class") element.className = value;
    else if (name in element) element[name] = value;
    else element.setAttribute(name, value);
  }
  element.append(...children.filter((child) => child !== null && child !== undefined));
  return element;
}

// A part of the card that folds.
function section(title, content, { open = true, count = null, id = null } = {}) {
  const summary = el("summary", {}, title);
  if (count !== null) summary.append(" ", el("span", { class: "count" }, String(count)));
  const details = el("details", { class: "section" }, summary, content);
  details.open = open;
  if (id) details.id = id;
  return details;
}

function button(text, title, onclick, kind = "") {
  return el("button", { type: "button", class: kind, title, onclick }, text);
}

function checkbox(text, checked, onchange) {
  const input = el("input", { type: "checkbox", checked, onchange: () => onchange(input.checked) });
  return { input, label: el("label", { class: "check" }, input, el("span", {}, text)) };
}

function choice(names, title, onchange) {
  const select = el("select", { title, "aria-label": title, onchange: () => onchange(Number(select.value)) });
  names.forEach((name, index) => select.append(el("option", { value: String(index) }, name)));
  return select;
}

// Whether a key pressed at an element is the element's own.
function keepsKeys(element) {
  return element instanceof HTMLTextAreaElement || element instanceof HTMLSelectElement ||
    (element instanceof HTMLInputElement && !["range", "checkbox", "radio"].includes(element.type));
}
