// A click on a heading sorts by its column; a second one turns the order. Cells may carry the value to sort by in data-v;
// cells without a number come last, whichever way.

function valueOf(row, column) {
  const cell = row.cells[column];
  if (!cell) return null;
  const text = cell.dataset.v ?? cell.textContent.trim();
  if (text === "") return null;
  const number = Number(text);
  return Number.isNaN(number) ? text : number;
}

function compare(a, b) {
  if (typeof a === "number" && typeof b === "number") return a - b;
  if (typeof a === "number") return -1;
  if (typeof b === "number") return 1;
  return a.localeCompare(b, undefined, { numeric: true });
}

export function sortRows(table, column, descending) {
  const body = table.tBodies[0];
  const rows = [...body.rows].map((row, index) => ({ row, index, value: valueOf(row, column) }));
  rows.sort((x, y) => {
    if (x.value === null || y.value === null) return (x.value === null) - (y.value === null) || x.index - y.index;
    return (descending ? -1 : 1) * compare(x.value, y.value) || x.index - y.index;
  });
  body.append(...rows.map(({ row }) => row));
}

export function makeSortable(table) {
  const headings = [...table.tHead.querySelectorAll("th[data-column]")];
  for (const heading of headings) {
    const button = document.createElement("button");
    button.type = "button";
    button.className = "sort";
    button.append(...heading.childNodes);
    heading.append(button);
    button.addEventListener("click", () => {
      const descending = heading.getAttribute("aria-sort") === "ascending";
      for (const other of headings) other.removeAttribute("aria-sort");
      heading.setAttribute("aria-sort", descending ? "descending" : "ascending");
      sortRows(table, Number(heading.dataset.column), descending);
    });
  }
}
