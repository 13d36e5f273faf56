// What a script can see of a page's layout, as `window.layoutChecks`; each returns what is wrong.
(() => {
  const CONTROLS = "button, input, select, textarea, a[href], summary";
  const MARGIN = 2; // of a line's box over its letters [px]
  const nameOf = (each) => each.ariaLabel ?? (each.textContent.trim() || each.id);
  const controls = () => [...document.querySelectorAll(CONTROLS)].filter((each) => each.checkVisibility());

  /** Return the part of a box that boxes around it leave; `cut` is told of those that hide a part for good. */
  function seenPart(start, box, cut = () => {}) {
    const seen = { left: box.left, right: box.right, top: box.top, bottom: box.bottom };
    for (let at = start; at && at !== document.body; at = at.parentElement) {
      const { overflowX, overflowY } = getComputedStyle(at);
      const edge = at.getBoundingClientRect();
      const wide = seen.right > edge.right + MARGIN || seen.left < edge.left - MARGIN;
      const tall = seen.bottom > edge.bottom + MARGIN || seen.top < edge.top - MARGIN;
      if ((overflowX === "hidden" && wide) || (overflowY === "hidden" && tall)) cut(at);
      if (overflowX !== "visible") Object.assign(seen, { left: Math.max(seen.left, edge.left), right: Math.min(seen.right, edge.right) });
      if (overflowY !== "visible") Object.assign(seen, { top: Math.max(seen.top, edge.top), bottom: Math.min(seen.bottom, edge.bottom) });
      if (seen.right <= seen.left || seen.bottom <= seen.top) return null;
    }
    return seen;
  }

  window.layoutChecks = {
    /** Text that reaches into what hides it and cannot be scrolled. What has a tooltip says all there. */
    cut() {
      const found = [];
      const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
      for (let node = walker.nextNode(); node; node = walker.nextNode()) {
        const text = node.textContent.trim();
        const holder = node.parentElement;
        if (!text || !holder.checkVisibility() || holder.closest("script, style, option")) continue;
        const range = document.createRange();
        range.selectNodeContents(node);
        seenPart(holder, range.getBoundingClientRect(), (at) => at.title || found.push(`${text.slice(0, 40)} in ${at.tagName}.${at.className}`));
      }
      const width = document.documentElement.scrollWidth;
      return width > innerWidth ? [...found, `the page is ${width} px wide`] : found;
    },

    /** Controls whose middle belongs to something else, though it is in sight. */
    covered() {
      return controls().flatMap((each) => {
        const seen = seenPart(each.parentElement, each.getBoundingClientRect());
        if (!seen || seen.right - seen.left < 4 || Math.min(seen.bottom, innerHeight) - seen.top < 4) return [];
        const at = document.elementFromPoint((seen.left + seen.right) / 2, (seen.top + Math.min(seen.bottom, innerHeight)) / 2);
        const isIts = at && (each.contains(at) || at.contains(each) || at.closest("label")?.contains(each));
        // The view of a narrow page stays in sight, and docks are scrolled below it.
        const isScrolled = innerWidth < 1000 && at?.closest("#scene") && !each.closest("#scene");
        return isIts || isScrolled ? [] : [`${nameOf(each)} below ${at?.tagName}#${at?.id}`];
      });
    },

    /** Note where all controls are, but those of messages, which come and go. */
    remember() {
      const kept = controls().filter((each) => !each.closest("#messages"));
      window.layoutChecks.places = new Map(kept.map((each) => [each, each.getBoundingClientRect()]));
    },

    /** Controls that are elsewhere by now. */
    moved() {
      return [...window.layoutChecks.places].flatMap(([each, was]) => {
        const now = each.getBoundingClientRect();
        const by = Math.abs(now.x - was.x) + Math.abs(now.y - was.y) + Math.abs(now.width - was.width);
        return each.checkVisibility() && by > 1 ? [nameOf(each)] : [];
      });
    },
  };
})();
