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
