// Tables that sort by the column whose header is clicked.

/** What a cell is sorted by: a number if it shows one, null for nothing, else its text. */
function rankOf(cell) {
  const text = cell.dataset.rank ?? cell.textContent.trim();
  if (text === "∞") return Infinity;
  if (text === "–" || text === "") return null;
  const number = Number(text.replace(/( best)?≈?$/, ""));
  return Number.isNaN(number) ? text : number;
}

/** Order of two ranks, upwards or downwards; nothing comes last both ways. */
function compareRanks(one, other, sign) {
  if (one === null || other === null) return (one === null) - (other === null);
  if (typeof one === "number" && typeof other === "number") return sign * (one === other ? 0 : one - other);
  return sign * String(one).localeCompare(String(other), undefined, { numeric: true });
}

/** Sort the table of `header` by its column: the best first, and the other way round when it is so already. */
function sortBy(header) {
  const opposite = { ascending: "descending", descending: "ascending" };
  const direction = opposite[header.ariaSort] ?? header.dataset.first;
  for (const other of header.parentElement.cells) other.removeAttribute("aria-sort");
  header.ariaSort = direction;
  const body = header.closest("table").tBodies[0];
  const ranked = [...body.rows].map((row) => ({ row, rank: rankOf(row.cells[header.cellIndex]) }));
  ranked.sort((one, other) => compareRanks(one.rank, other.rank, direction === "ascending" ? 1 : -1));
  body.append(...ranked.map(({ row }) => row));
}

for (const header of document.querySelectorAll("th[data-first]")) {
  header.querySelector("button").addEventListener("click", () => sortBy(header));
}
