// Lessons: the task, answers, and what the station says of the student's own run.
import { act, choice, h, html, kept, nothing, offer, Panel, peek, press, store, typed } from "../lib/panel.js";

/** Return a line of Markdown as a template: bold, emphasis and code. */
function inline(text) {
  return text.split(/(\*\*[^*]+\*\*|\*[^*]+\*|`[^`]+`)/).map((part) => {
    if (part.startsWith("**")) return html`<b>${part.slice(2, -2)}</b>`;
    if (part.startsWith("`")) return html`<code>${part.slice(1, -1)}</code>`;
    return part.length > 2 && part.startsWith("*") ? html`<em>${part.slice(1, -1)}</em>` : part;
  });
}

/** Return Markdown as a template: paragraphs and numbered lists; everything else is text. */
function markdown(text) {
  return text.trim().split(/\n\s*\n/).map((block) => {
    const items = block.split(/\n?^\d+\.\s+/m).filter(Boolean);
    return /^\d+\./.test(block) ? html`<ol>${items.map((item) => html`<li>${inline(item.replace(/\s*\n\s*/g, " "))}</li>`)}</ol>` : html`<p>${inline(block.replace(/\s*\n\s*/g, " "))}</p>`;
  });
}

customElements.define("st-lessons", class LessonBook extends Panel {
  build() {
    const name = () => {
      kept.set("person", this.person.value.trim());
      this.list();
    };
    this.person = h("input", { class: "name", placeholder: "your name", value: kept.get("person", ""), ariaLabel: "Name of the student", onchange: name });
    const choose = () => {
      this.result = null;
      this.refresh();
    };
    this.choice = choice("Lesson", [], choose);
    this.lessons = [];
    store.addEventListener("docks", () => !this.isListed && store.docks.link === "live" && this.isShown && this.list());
    this.refresh();
  }

  async list() {
    this.isListed = true;
    const answer = await peek(`/lessons?person=${encodeURIComponent(this.person.value.trim())}`);
    if (!answer) return (this.isListed = false);
    const chosen = this.choice.value || answer.lessons.find((one) => one.is_begun)?.name || answer.lessons.find((one) => !one.is_solved)?.name;
    this.lessons = answer.lessons;
    this.unusable = answer.unusable;
    offer(this.choice, answer.lessons.map((one, i) => [one.name, `${one.is_solved ? "✔ " : ""}${i + 1}. ${one.title}`]));
    if (chosen) this.choice.value = chosen;
    return this.refresh();
  }

  async begin(lesson) {
    if (!(await act("POST", `/lessons/${lesson.name}/begin`, { person: this.person.value.trim() }))) return;
    this.result = null;
    await this.list();
  }

  async check(lesson) {
    const inputs = [...this.querySelectorAll("input.value")];
    const answers = Object.fromEntries(inputs.map((input) => [input.name, typed(input.value)]).filter(([, value]) => value !== null));
    this.result = await act("POST", `/lessons/${lesson.name}/check`, { person: this.person.value.trim(), answers });
    await this.list();
  }

  view() {
    const lesson = this.lessons.find(({ name }) => name === this.choice.value);
    return html`<div class="line">${this.choice}${this.person}</div><div class="lesson">${lesson ? this.page(lesson) : nothing}</div>`;
  }

  page(lesson) {
    const verdict = (one) => html`<li class=${one.is_met ? "" : "fault"}>${one.is_met ? "✔" : "✖"} ${one.says}${one.hint ? html`<p class="hint">${inline(one.hint)}</p>` : nothing}</li>`;
    return html`${markdown(lesson.text)}
        <div class="line">
          ${press(lesson.is_begun ? "Begin anew" : "Begin", "", () => this.begin(lesson), { look: lesson.is_begun ? "s" : "s primary", needs: "change" })}
          ${lesson.answers.map((answer) => html`<label>${answer.label} <input class="value" name=${answer.name} inputmode="decimal" autocomplete="off" aria-label="${answer.label} [${answer.unit}]" /> ${answer.unit}</label>`)}
          ${press("Check", "", () => this.check(lesson), { look: lesson.is_begun ? "s primary" : "s", needs: "change", off: !lesson.is_begun })}
        </div>
        <div role="status">${this.result ? html`<b>${this.result.is_solved ? "Solved." : "Not solved yet."}</b><ul class="verdicts">${this.result.verdicts.map(verdict)}</ul>` : nothing}</div>
        ${this.unusable?.length ? html`<p class="hint">Left out: ${this.unusable.join(" ")}</p>` : nothing}`;
  }
});
