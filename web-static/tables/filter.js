// A text field above a table: rows that do not hold every word are hidden.

export function hasWords(text, words) {
  return words.every((word) => text.includes(word));
}

export function addFilter(table) {
  const label = document.createElement("label");
  label.className = "filter";
  label.textContent = table.dataset.filter + " ";
  const field = document.createElement("input");
  field.type = "search";
  label.append(field);
  const count = document.createElement("span");
  count.className = "soft";
  count.setAttribute("role", "status");
  label.append(" ", count);
  const place = table.closest(".scroll") ?? table;
  place.before(label);
  const texts = new Map([...table.tBodies[0].rows].map((row) => [row, row.textContent.toLowerCase()]));
  field.addEventListener("input", () => {
    const words = field.value.toLowerCase().split(/\s+/).filter(Boolean);
    let shown = 0;
    for (const [row, text] of texts) {
      row.hidden = !hasWords(text, words);
      shown += row.hidden ? 0 : 1;
    }
    count.textContent = words.length ? `${shown} of ${texts.size}` : "";
  });
}
