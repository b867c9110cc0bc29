// Figures open at their full size: a click, Enter, or without this script the address of the file.
addEventListener("DOMContentLoaded", () => {
  const box = document.createElement("dialog");
  box.className = "zoom";
  box.setAttribute("aria-label", "Figure at full size");
  box.innerHTML = '<form method="dialog"><button aria-label="Close">×</button></form>';
  const large = box.appendChild(new Image());
  box.addEventListener("click", (event) => event.target === box && box.close());
  document.body.append(box);
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
});
