"use strict";
// What the page does beside plots and viewers: contents, theme, tables, printing.

for (const cell of document.querySelectorAll("[data-method]")) {
  cell.style.setProperty("--method", methodColour(cell.dataset.method));
}

document.querySelector(".theme").addEventListener("click", theme.toggle);

// Contents: always open beside the text, closed above it until asked for.
{
  const details = document.querySelector(".contents details");
  const wide = matchMedia("(min-width: 62rem)");
  const arrange = () => { details.open = wide.matches; };
  wide.addEventListener("change", arrange);
  arrange();
  details.querySelector("summary").addEventListener("click", (event) => wide.matches && event.preventDefault());
  details.querySelector(".contents-list").addEventListener("click", (event) => {
    if (event.target.closest("a")) arrange();
  });

  const links = new Map([...details.querySelectorAll("a")].map((link) => [link.hash.slice(1), link]));
  const headings = [...links.keys()].map((id) => document.getElementById(id));
  let queued = false;
  const follow = () => {
    queued = false;
    const current = headings.filter((heading) => heading.getBoundingClientRect().top < 120).at(-1);
    for (const [id, link] of links) {
      if (id === current?.id) {
        if (!link.hasAttribute("aria-current") && wide.matches) link.scrollIntoView({ block: "nearest" });
        link.setAttribute("aria-current", "true");
      } else {
        link.removeAttribute("aria-current");
      }
    }
  };
  addEventListener("scroll", () => {
    if (!queued) requestAnimationFrame(follow);
    queued = true;
  }, { passive: true });
  follow();
}

// Tables: a click on a header sorts, another one the other way round. What is not there comes last.
for (const table of document.querySelectorAll(".table table")) {
  table.tHead.addEventListener("click", (event) => {
    const header = event.target.closest("th");
    if (!event.target.closest(".sort")) return;
    const ascending = header.getAttribute("aria-sort") !== "ascending";
    for (const other of table.tHead.rows[0].cells) other.removeAttribute("aria-sort");
    header.setAttribute("aria-sort", ascending ? "ascending" : "descending");
    const numeric = header.classList.contains("number");
    const keyed = [...table.tBodies[0].rows].map((row) => {
      const cell = row.cells[header.cellIndex];
      return { row, key: numeric ? (cell.dataset.value === "" ? null : Number(cell.dataset.value)) : cell.textContent };
    });
    keyed.sort((a, b) => {
      if (a.key === null || b.key === null) return (a.key === null) - (b.key === null);
      const order = numeric ? a.key - b.key : a.key.localeCompare(b.key, "en", { numeric: true });
      return ascending ? order : -order;
    });
    table.tBodies[0].append(...keyed.map(({ row }) => row));
  });
}

document.querySelectorAll("[data-viewer]").forEach((figure) => new Viewer(figure, window.lampyris.viewers[figure.dataset.viewer]));

// Paper is light, and shows plots that nobody has scrolled to.
addEventListener("beforeprint", () => {
  theme.printing = true;
  theme.apply();
  plots.drawAll();
});
addEventListener("afterprint", () => {
  theme.printing = false;
  theme.apply();
});
