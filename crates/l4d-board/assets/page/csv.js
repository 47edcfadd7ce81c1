// Tables as files, made in the browser.

/** Text that a spreadsheet would run as a formula is behind an apostrophe, as in the files of l4d. */
function csvField(value) {
  if (value === null || value === undefined) return "";
  const text = typeof value === "string" ? value.replace(/^[=+\-@\t\r]/, "'$&") : String(value);
  return /[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}

/** A line a row. A column is a field of its key, or has `fields`: pairs of a name and what gives its value. */
function csvOf(columns, rows) {
  const fields = columns.filter((column) => !column.isDrawn).flatMap((column) => column.fields ?? [[column.key, column.value]]);
  const lines = [fields.map(([name]) => name), ...rows.map((row) => fields.map(([, value]) => value(row)))];
  return lines.map((line) => `${line.map(csvField).join(",")}\n`).join("");
}

/** A button that hands over a file; `make` gives its text when it is pressed. */
function download(title, file, make) {
  const press = async () => {
    const link = el("a", { href: URL.createObjectURL(new Blob([await make()], { type: "text/csv" })), download: file() });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
  };
  return el("p", { class: "tools" }, el("button", { type: "button", onclick: press }, title));
}
