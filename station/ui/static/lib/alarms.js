// The alarms of the station: what asks for a person, and who has seen it. The strip counts
// those that nobody has seen; the dock Timeline lists and acknowledges them.
import { act, follow, forPerson, html, nothing, peek, press, repeat, show, units } from "./panel.js";

const LOOK_MS = 2000;

class Alarms extends EventTarget {
  list = [];

  /** Begin to look; `button` is the count on the strip, `open` shows the list. */
  start(button, open) {
    this.button = button;
    button.addEventListener("click", open);
    // Every change of an alarm's cause is an event; the timer finds what was missed.
    follow("events", "rate=10", (frame) => frame.data.kind !== "request" && this.look());
    setInterval(() => this.look(), LOOK_MS);
    this.look();
  }

  async look() {
    const answer = await peek("/alarms");
    if (!answer) return;
    this.list = answer.alarms;
    const unseen = answer.unacknowledged;
    this.button.dataset.unseen = unseen ? "some" : "";
    show(this.button, unseen ? `▲ Alarms ${unseen}` : this.list.length ? `Alarms, seen` : "No alarms");
    this.dispatchEvent(new Event("change"));
  }

  async acknowledge(alarms) {
    for (const alarm of alarms) await act("POST", `/alarms/${alarm.id}/acknowledge`);
    await this.look();
  }
}

export const alarms = new Alarms();

const clock = (time) => new Date(time * 1e3).toLocaleTimeString("en-GB");

function row(alarm) {
  const seen = alarm.acknowledged_at !== null;
  const gone = alarm.cleared_at === null ? "still there" : `gone since ${clock(alarm.cleared_at)}`;
  const state = `${gone}, ${seen ? `seen by ${alarm.acknowledged_by} at ${clock(alarm.acknowledged_at)}` : "not acknowledged"}`;
  return html`<div class="row ${alarm.severity}">
    <time title=${new Date(alarm.raised_at * 1e3).toISOString()}>${clock(alarm.raised_at)}</time>
    <b>${alarm.severity === "error" ? "✖" : "▲"} ${units.words(alarm.text)} </b>
    <span class="remedy">${forPerson(alarm.remedy ?? "")}</span>
    <small> ${state} </small>
    ${seen ? nothing : press("Acknowledge", "Confirm that you have seen the alarm; nothing moves, and nothing is cleared.", () => alarms.acknowledge([alarm]), { needs: "change", name: `Acknowledge ${alarm.text}` })}
  </div>`;
}

/** Return the rows of the list as a template, and one button for all that nobody has seen. */
export function alarmRows() {
  if (!alarms.list.length) return html`<p class="hint">Nothing asks for attention, and everything that did was seen.</p>`;
  const unseen = alarms.list.filter((alarm) => alarm.acknowledged_at === null);
  const all = html`<div class="line">${press("Acknowledge all", "", () => alarms.acknowledge(unseen), { needs: "change" })}</div>`;
  return html`${unseen.length > 1 ? all : nothing}${repeat(alarms.list, ({ id }) => id, row)}`;
}
