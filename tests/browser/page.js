// What a page is asked, whatever it shows: each function returns a list of complaints.
window.book = (() => {
  // What is asked of a page that is on its way to another theme would be true of neither.
  const still = document.createElement("style");
  still.textContent = "*, ::before, ::after { transition: none !important; animation: none !important; }";
  document.head.append(still);

  const name = (element) => {
    const marks = [...element.classList].slice(0, 2).map((mark) => `.${mark}`);
    const text = element.textContent.trim().replace(/\s+/g, " ").slice(0, 40);
    return `${element.localName}${element.id && `#${element.id}`}${marks.join("")} "${text}"`;
  };
  const scrolls = (element) => getComputedStyle(element).overflowX !== "visible";

  // Nothing reaches beyond the page, unless it scrolls in a box of its own.
  function tooWide() {
    const root = document.documentElement, width = root.clientWidth;
    // Texts of a drawing that leave it make no page wider: they are cut.
    const cut = [...document.querySelectorAll(".explorable svg text")].filter((text) => {
      const { left, right } = text.getBoundingClientRect();
      return left < 0 || right > width;
    });
    const found = cut.map((text) => `is cut: ${name(text)}`);
    if (root.scrollWidth <= width) return found;
    const inBox = (element) => {
      for (let box = element.parentElement; box; box = box.parentElement) {
        if (box !== document.body && box !== root && scrolls(box)) return true;
      }
      return false;
    };
    const wide = [...document.body.querySelectorAll("*")].filter((element) => {
      const box = element.getBoundingClientRect();
      return box.width && box.right > width + 1 && !inBox(element);
    });
    return [...found, `scrolls sideways, ${root.scrollWidth} px: ${wide.slice(-3).map(name).join(", ")}`];
  }

  // Words of a table stand side by side: a column of one word a line is no text.
  function squeezed() {
    const letters = (cell) => cell.clientWidth / parseFloat(getComputedStyle(cell).fontSize);
    const cells = [...document.querySelectorAll(".bd-article td")].filter(
      (cell) => cell.clientWidth && letters(cell) < 8 && cell.innerText.trim().split(/\s+/).length > 7,
    );
    return cells.map((cell) => `is squeezed into ${cell.clientWidth} px: ${name(cell)}`);
  }

  function broken() {
    const found = [];
    for (const image of document.querySelectorAll("img[src]")) {
      if (!image.complete || !image.naturalWidth) found.push(`a picture is not shown: ${image.src}`);
    }
    for (const formula of document.querySelectorAll(".math")) {
      if (!formula.querySelector("mjx-container svg")) found.push(`a formula is not set: ${name(formula)}`);
    }
    // The theme's script puts pictures in the place of icons, and a mark where it has none.
    for (const icon of document.querySelectorAll("i[class*=fa-], svg[data-icon]:has(.missing)")) {
      found.push(`an icon is missing: ${name(icon)}`);
    }
    for (const wrong of document.querySelectorAll("[data-mml-node=merror]")) {
      found.push(`a formula is wrong: ${wrong.textContent}`);
    }
    const texts = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    while (texts.nextNode()) {
      const { data, parentElement } = texts.currentNode;
      if (/\\[(\[]|\\begin\{|\\frac|\$[^$\n]+\$/.test(data)) {
        if (!parentElement.closest("script, style, code, pre, mjx-container")) {
          found.push(`a formula is left as text: ${name(parentElement)}`);
        }
      }
    }
    return found;
  }

  // What axe would look at again and again: glyphs, and tokens of code of a kind that was met.
  function thin() {
    const kinds = new Set();
    for (const token of document.querySelectorAll(".highlight pre span:not(:has(*))")) {
      if (kinds.has(token.className)) token.replaceWith(...token.childNodes);
      kinds.add(token.className);
    }
    const formulas = "mjx-container > svg, mjx-container math";
    for (const formula of document.querySelectorAll(formulas)) formula.replaceChildren();
  }

  // How many letters links have, and how many are beside them, in the line of a text that holds a link.
  function line(text, link) {
    let counted = { links: 0, beside: 0 }, here = false;
    const nodes = document.createTreeWalker(text, NodeFilter.SHOW_ELEMENT | NodeFilter.SHOW_TEXT);
    while (nodes.nextNode()) {
      const node = nodes.currentNode;
      if (node === link) here = true;
      else if (node.localName === "br") {
        if (here) break;
        counted = { links: 0, beside: 0 };
      } else if (node.nodeType === Node.TEXT_NODE) {
        counted[node.parentElement.closest("a[href]") ? "links" : "beside"] += node.data.replace(/\s/g, "").length;
      }
    }
    return counted;
  }

  // Marks one text for each look that is not known: all others of its color, size and weight on its
  // background have its contrast. Likewise one link in a text, for each look beside that of the text.
  // Returns the looks that are new.
  function mark(known) {
    for (const name of ["look", "link"]) {
      for (const marked of document.querySelectorAll(`[data-${name}]`)) delete marked.dataset[name];
    }
    const grounds = new Map([[null, ""]]);
    const ground = (element) => {
      if (!grounds.has(element)) {
        const { backgroundColor, backgroundImage, opacity } = getComputedStyle(element);
        const below = ground(element.parentElement);
        const own = `${backgroundColor} ${backgroundImage} ${opacity}`;
        if (own === "rgba(0, 0, 0, 0) none 1") grounds.set(element, below);
        else if (/^rgb\(.* none 1$/.test(own)) grounds.set(element, backgroundColor);
        else grounds.set(element, `${below}|${own}`);
      }
      return grounds.get(element);
    };
    const old = new Set(known), found = [];
    const texts = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    while (texts.nextNode()) {
      const element = texts.currentNode.parentElement;
      if (!texts.currentNode.data.trim() || !element.checkVisibility()) continue;
      const { color, fontSize, fontWeight } = getComputedStyle(element);
      const look = [color, fontSize, fontWeight, ground(element)].join(" ");
      if (old.has(look)) continue;
      old.add(look);
      found.push(look);
      element.dataset.look = "";
    }

    const style = (element) => {
      const { color, font, textDecorationLine, borderTop, borderBottom, outline } = getComputedStyle(element);
      return [color, font, textDecorationLine, borderTop, borderBottom, outline].join(" ");
    };
    const unclear = new Map();
    for (const link of document.querySelectorAll("a[href]")) {
      if (!link.checkVisibility()) continue;
      let text = link.parentElement;
      while (getComputedStyle(text).display === "inline") text = text.parentElement;
      const { links, beside } = line(text, link);
      if (!beside) continue;
      const look = ["link", link.className, style(link), style(text), ground(link)].join(" ");
      if (old.has(look)) continue;
      // Where links are longer than what is beside them, axe decides whether they stand in a text.
      if (beside <= links) unclear.set(look, [...(unclear.get(look) ?? []), link]);
      else {
        old.add(look);
        found.push(look);
        link.dataset.link = "";
      }
    }
    for (const [look, links] of unclear) {
      if (!old.has(look)) for (const link of links) link.dataset.link = "";
    }
    return found;
  }

  const impacts = ["serious", "critical"];
  const heavy = (result) =>
    result.violations
      .filter(({ impact }) => impacts.includes(impact))
      .flatMap(({ id, nodes }) => nodes.map((node) => {
        const why = [...node.any, ...node.all, ...node.none].map(({ message }) => message);
        return `axe: ${id}: ${node.target.join(" ")}: ${why.join("; ")}`;
      }));
  // What axe finds with the rules of these impacts, or with those of colors alone.
  const colors = { "color-contrast": "[data-look]", "link-in-text-block": "[data-link]" };
  const axeFinds = (colorsOnly) => {
    axe.configure({ rules: Object.entries(colors).map(([id, selector]) => ({ id, selector })) });
    const rules = axe._audit.rules.filter(({ enabled, impact }) => enabled && impacts.includes(impact));
    const chosen = colorsOnly ? Object.keys(colors) : rules.map(({ id }) => id);
    const options = { resultTypes: ["violations"], preload: false, performanceTimer: false };
    return axe.run(document, { ...options, runOnly: chosen }).then(heavy);
  };
  return { tooWide, squeezed, broken, thin, mark, axeFinds };
})();
