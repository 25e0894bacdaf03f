"use strict";
// What is behind a number: a panel with the runs, their commands and settings. And the block with a command that viewers show, too.

/** An element with attributes and children. */
function element(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === true) made.setAttribute(name, "");
    else if (value !== false && value !== null && value !== undefined) made.setAttribute(name, value);
  }
  made.append(...children.filter((child) => child !== null && child !== undefined));
  return made;
}

/** A command in a block, with a button that copies it. */
function commandBlock(command) {
  const words = command.split(" ").flatMap((word, index) => [index ? " " : "", element("span", {}, word)]);
  const code = element("code", {}, ...words);
  const button = element("button", { type: "button", "aria-label": "Copy the command" }, "Copy");
  button.addEventListener("click", () => copy(code, button));
  return element("div", { class: "command" }, button, code);
}

async function copy(code, button) {
  const select = () => getSelection().selectAllChildren(code);
  let told = "Copied";
  try {
    await navigator.clipboard.writeText(code.textContent);
  } catch {
    select(); // a page from a file may be refused the clipboard: the reader's own Ctrl+C is not
    told = "Selected";
  }
  button.textContent = told;
  document.getElementById("told").textContent = `${told}: the command`;
  setTimeout(() => { button.textContent = "Copy"; }, 1500);
}

const runs = (() => {
  const panel = document.querySelector(".panel");
  let opener = null;

  function describe(key) {
    const parts = [element("h5", { title: "The run's key" }, key)];
    const record = window.lampyris.runs[key];
    if (!record) return parts;
    if (record.command) parts.push(commandBlock(record.command));
    const settings = Object.entries(record.spec).flatMap(([name, value]) => [
      element("dt", {}, name),
      element("dd", {}, typeof value === "object" ? JSON.stringify(value) : String(value)),
    ]);
    if (settings.length) parts.push(element("dl", {}, ...settings));
    return parts;
  }

  /** Open the panel with these runs. */
  function show(heading, keys) {
    opener = document.activeElement;
    panel.querySelector("strong").textContent = `${heading}: ${keys.length === 1 ? "the run" : `${keys.length} runs`}`;
    panel.querySelector(".panel-body").replaceChildren(...keys.flatMap(describe));
    panel.querySelector(".panel-body").scrollTop = 0;
    panel.hidden = false;
    panel.focus({ preventScroll: true });
  }

  function hide() {
    if (panel.hidden) return;
    panel.hidden = true;
    opener?.focus({ preventScroll: true });
  }

  panel.querySelector(".close").addEventListener("click", hide);
  document.addEventListener("keydown", (event) => event.key === "Escape" && hide());
  document.addEventListener("click", (event) => {
    const button = event.target.closest("button[data-runs]");
    if (button) show(button.dataset.heading, button.dataset.runs.split(" "));
  });

  return { show };
})();
