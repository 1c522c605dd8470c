// What the history of a robot's sensors says, in words.
import { digits } from "./digits.js";
import { OFF_SIGMAS, sigmasText } from "../sigmas.js";

export const isOff = (row) => (row.in_sigmas ?? 0) >= OFF_SIGMAS;
export const farthest = (rows) => rows.reduce((most, row) => ((row.in_sigmas ?? 0) > (most.in_sigmas ?? 0) ? row : most), rows[0]);
export const sigmas = (row) => `${sigmasText(row.in_sigmas ?? 0)} \u03c3`;

// What a point of a series is called: a revision, or a visit by the day on which it was captured.
export const nameOf = (row) => (row.revision ? `revision ${row.revision}` : `visit of ${row.date}`);

// The solution is a mean of old and new measurements: what moved once keeps stepping while new ones come.
function whenMoved(rows) {
  const off = rows.filter(isOff), last = off.at(-1);
  if (off.length === 1) return `revision ${last.revision} (${sigmas(last)})`;
  return `revision ${off[0].revision} (${sigmas(off[0])}), ` + (off.length > 2 ? `${off.length - 1} times more until` : "again at") + ` revision ${last.revision}`;
}

// Of a long history only the newest revisions are drawn.
function sinceWhen(trends) {
  const first = Math.min(...trends.map(({ rows }) => rows[0].revision));
  return first > 1 ? `Since revision ${first}: ` : "";
}

// What each visit says by itself. The revisions, a mean of visits, show a step later and smaller, so this goes first.
function visitsText(trends) {
  const stepped = trends.flatMap(({ sensor, visits = [] }) => visits.filter(isOff).slice(-1).map((row) => ({ sensor, row })));
  if (stepped.length === 0) return "";
  stepped.sort((a, b) => b.row.in_sigmas - a.row.in_sigmas);
  const said = stepped.slice(0, 3).map(({ sensor, row }) => `${sensor} by ${digits(row.moved_m * 1000, 2)} mm and ${digits(row.turned_rad * 180 / Math.PI, 2)} deg before the visit of ${row.date} (${sigmas(row)})`);
  const more = stepped.length > 3 ? `, and ${stepped.length - 3} more sensors` : "";
  return `Visit against visit, moved: ${said.join("; ")}${more}. `;
}

function revisionsText(trends) {
  const known = byFarthestStep(trends).filter((trend) => trend.rows.length > 1);
  if (known.length === 0) return "No sensor is known in two revisions with one reference.";
  const moved = known.filter((trend) => trend.rows.some(isOff));
  const since = sinceWhen(known), told = (text) => (since ? since + text[0].toLowerCase() + text.slice(1) : text);
  if (moved.length === 0) return told("No sensor stepped by 3 \u03c3 or more from one revision to the next.");
  const said = moved.slice(0, 3).map(({ sensor, rows }) => `${sensor} at ${whenMoved(rows)}`);
  const more = moved.length > 3 ? `, and ${moved.length - 3} more sensors` : "";
  const rest = known.length - moved.length;
  return told(`Moved: ${said.join("; ")}${more}.` + (rest > 0 ? ` The other ${rest === 1 ? "one" : rest} stepped by less than 3 \u03c3.` : ""));
}

// "front_right moved at revision 3 (67.7 sigma) ...": what the charts show, in one sentence.
export function historyText(trends) {
  const visits = visitsText(trends), revisions = revisionsText(trends);
  if (!visits || trends.some(({ rows }) => rows.some(isOff))) return visits + revisions;
  return visits + "The revisions are a mean of visits: theirs is the smaller step.";
}

export function byFarthestStep(trends) {
  const most = ({ rows, visits = [] }) => farthest([...rows, ...visits]).in_sigmas ?? 0;
  return [...trends].sort((a, b) => most(b) - most(a) || a.sensor.localeCompare(b.sensor));
}
