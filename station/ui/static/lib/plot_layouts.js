// Layouts of the plots: kept at the station under a name, or in a file.
import { act, h, html, nameField, peek, press, refusals, render } from "./panel.js";
import { download } from "./plot.js";

const ROUTE = "/plot-layouts";
export const layoutPath = (name) => `${ROUTE}/${encodeURIComponent(name)}`;

/** Return the names of the layouts that the station keeps; null without an answer. */
export const layoutNames = async () => (await peek(ROUTE))?.plot_layouts ?? null;

/** Return the plots of a layout that a file or a link has; null when it has none. */
export function plotsIn(text) {
  try {
    const read = JSON.parse(text);
    const plots = Array.isArray(read) ? read : read.plots;
    const isPlot = ({ keys, span }) => Array.isArray(keys) && keys.every((key) => typeof key === "string") && span > 0;
    return Array.isArray(plots) && plots.every(isPlot) ? plots : null;
  } catch {
    return null;
  }
}

/** Return the plots of a layout that a link names or holds; undefined when there is none. */
export async function layoutOf(text) {
  return plotsIn(text) ?? (await act("GET", layoutPath(text)))?.plots;
}

/** Return a menu of the layouts; `settings()` are the present plots, `put(plots)` shows others. */
export function layoutMenu(settings, put) {
  const body = h("div", {});
  const menu = h("details", { class: "picker layouts", ontoggle: () => menu.open && list() }, h("summary", { title: "Keep these plots under a name, or show others." }, "Layouts"), body);
  const name = nameField("Name of the layout", "name", () => save(), { class: "", type: "text", maxLength: 100 });
  const file = h("input", { type: "file", accept: ".json", hidden: true, onchange: () => file.files[0]?.text().then(importText) });
  const importText = (text) => {
    file.value = "";
    const plots = plotsIn(text);
    if (plots) return put(plots);
    return refusals.add({ code: "no_layout", detail: "The file holds no layout of plots.", remedy: "Choose a file that Export has saved." }, {});
  };
  let known = { name: "", text: "" }; // the layout that is shown, while nothing of it is changed
  const remember = (shown) => (known = { name: shown, text: JSON.stringify(settings()) });
  const change = async (method, wanted, content) => {
    if (!(await act(method, layoutPath(wanted), content))) return;
    remember(method === "PUT" ? wanted : "");
    await list();
  };
  const save = () => name.value.trim() && change("PUT", name.value.trim(), { plots: settings() });
  const show = async (wanted) => {
    const plots = await layoutOf(wanted);
    if (!plots) return;
    put(plots);
    name.value = wanted;
    remember(wanted);
  };
  const row = (each) => html`<div class="channel">${press(each, "", () => show(each), { look: "choice" })}${press("✕", "", () => change("DELETE", each), { look: "choice rate", needs: "change", name: `Delete the layout ${each}` })}</div>`;
  const list = async () => {
    const names = (await layoutNames()) ?? [];
    const none = html`<p class="hint">None is saved yet.</p>`;
    render(html`${names.length ? names.map(row) : none}
      <div class="line">${name}${press("Save", "", save, { needs: "change", off: () => !name.value.trim() })}</div>
      <div class="line">${press("Export", "Save these plots as a file.", () => download(`${name.value.trim() || "plots"}.json`, JSON.stringify({ plots: settings() }, null, 1), "application/json"))}${press("Import", "Show the plots of a file.", () => file.click())}${file}</div>`, body);
  };
  /** The name of the layout that is shown, else its content. */
  menu.linked = () => {
    const text = JSON.stringify(settings());
    return known.name && known.text === text ? known.name : text;
  };
  return menu;
}
