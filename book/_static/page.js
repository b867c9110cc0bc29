// Pages that were opened as files may not fetch each other: the search shows no excerpts there.
if (location.protocol === "file:") DOCUMENTATION_OPTIONS.SHOW_SEARCH_SUMMARY = false;

// Figures open at their full size: a click, or Enter; without this script, the address of the file.
addEventListener("DOMContentLoaded", () => {
  const box = document.createElement("dialog");
  box.className = "zoom";
  box.setAttribute("aria-label", "Figure at full size");
  box.innerHTML = '<form method="dialog"><button aria-label="Close">×</button></form><img alt="">';
  box.addEventListener("click", (event) => event.target === box && box.close());
  document.body.append(box);
  const large = box.querySelector("img");
  for (const image of document.querySelectorAll(".bd-article figure img")) {
    const link = image.closest("a") || document.createElement("a");
    if (!link.isConnected) {
      image.replaceWith(link);
      link.append(image);
    }
    link.href = image.src;
    link.classList.add("zoom");
    link.title = "Open at full size";
    link.addEventListener("click", (event) => {
      if (event.ctrlKey || event.metaKey || event.shiftKey) return;
      event.preventDefault();
      large.src = image.src;
      large.alt = image.alt;
      box.showModal();
    });
  }
  // The theme names these otherwise than they read, or not at all.
  for (const button of document.querySelectorAll(".search-button-field, .theme-switch-button")) {
    button.title ||= button.ariaLabel;
    button.removeAttribute("aria-label");
  }
  for (const fold of document.querySelectorAll(".bd-sidebar-primary summary")) {
    fold.ariaLabel = `Pages of ${fold.closest("li").querySelector("a").textContent}`;
  }
});

// A formula that is wider than the page can be reached by the keyboard, and scrolled.
addEventListener("load", () =>
  window.MathJax?.startup?.promise?.then(() => {
    for (const box of document.querySelectorAll("mjx-container, .bd-content div.math")) {
      if (box.scrollWidth > box.clientWidth && box.clientWidth) box.tabIndex = 0;
    }
  }),
);

// In a table that is wider than the page, an interval stands below its value: `<wbr>` is between.
addEventListener("DOMContentLoaded", () => {
  const watch = new ResizeObserver((changes) => {
    for (const { target: box } of changes) {
      const table = box.querySelector("table.results");
      table.classList.remove("narrow");
      table.classList.toggle("narrow", box.scrollWidth > box.clientWidth);
    }
  });
  for (const box of document.querySelectorAll(".output:has(> table.results)")) watch.observe(box);
});

// A table of three or more columns with sentences: on a phone each row is a card, whose lines name the column.
addEventListener("DOMContentLoaded", () => {
  for (const table of document.querySelectorAll(".bd-article table:not(.results)")) {
    if (!(table.tHead?.rows[0].cells.length > 2)) continue;
    const cells = [...table.tBodies[0].rows].flatMap((row) => [...row.cells]);
    if (!cells.some((cell) => cell.textContent.trim().length > 25)) continue;
    table.classList.add("cards");
    const heads = [...table.tHead.rows[0].cells].map((head) => head.textContent.trim());
    for (const cell of cells) {
      if (cell.cellIndex) cell.dataset.head = heads[cell.cellIndex];
      cell.classList.toggle("none", ["", "—"].includes(cell.textContent.trim()));
    }
  }
});

// A scorecard: the number of each verdict, and buttons that leave rows out.
addEventListener("DOMContentLoaded", () => {
  for (const table of document.querySelectorAll(".bd-article table:has(td:first-child .verdict)")) {
    const rows = new Map();
    for (const row of table.tBodies[0].rows) {
      const word = row.querySelector(".verdict")?.textContent;
      if (word) rows.set(word, [...(rows.get(word) ?? []), row]);
    }
    if (rows.size < 2 || table.tBodies[0].rows.length < 10) continue;
    const bar = document.createElement("div");
    bar.className = "verdict-bar d-print-none";
    bar.append("Show: ");
    for (const [word, those] of rows) {
      const button = document.createElement("button");
      button.textContent = `${those.length} ${word}`;
      button.className = `verdict verdict-${word}`;
      button.ariaPressed = "true";
      button.addEventListener("click", () => {
        const shown = button.ariaPressed !== "true";
        button.ariaPressed = String(shown);
        for (const row of those) row.hidden = !shown;
      });
      bar.append(button);
    }
    (table.closest(".pst-scrollable-table-container") ?? table).before(bar);
  }
});

// What was tried is folded: below two lines of a number on a scorecard, below the verdict in a chapter.
addEventListener("DOMContentLoaded", () => {
  const kept = { "table:has(td:first-child .verdict) td:nth-child(3)": 2, "td:last-child:has(.verdict)": 1 };
  for (const [cells, lines] of Object.entries(kept)) {
    for (const cell of document.querySelectorAll(`.bd-article ${cells}`)) {
      const breaks = cell.querySelectorAll("br");
      if (breaks.length <= lines) continue;
      const last = breaks[lines - 1], fold = document.createElement("details");
      fold.innerHTML = "<summary>over all choices</summary>";
      while (last.nextSibling) fold.append(last.nextSibling);
      last.replaceWith(fold);
    }
  }
});
addEventListener("beforeprint", () => {
  for (const fold of document.querySelectorAll("td details")) fold.open = true;
});

// Paper is white: a page that is dark would be printed in pale letters.
{
  const page = document.documentElement;
  let worn;
  addEventListener("beforeprint", () => {
    worn = page.dataset.theme;
    page.dataset.theme = "light";
  });
  addEventListener("afterprint", () => (page.dataset.theme = worn));
}
