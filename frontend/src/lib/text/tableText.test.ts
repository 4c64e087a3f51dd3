import { expect, test } from "vitest";
import { areRecords, recordsCsv, recordsJson, tableCsv, tableJson, tableText } from "./tableText";

test("a table is copied and saved as spreadsheets and programs read it", () => {
  document.body.innerHTML = `
    <table>
      <thead><tr><th>Derivative</th><th><button>Value <span aria-hidden="true">↑</span></button></th></tr></thead>
      <tbody>
        <tr><td><span role="img" aria-label="CZ_alpha">C<sub>Zα</sub></span> [1/rad]</td><td>\u22124.6</td></tr>
        <tr><td>delay</td><td>\u2013</td></tr>
      </tbody>
    </table>`;
  const table = document.querySelector("table");
  if (table === null) throw new Error("no table");
  expect(tableText(table)).toBe("Derivative\tValue\nCZ_alpha [1/rad]\t-4.6\ndelay\t\n");
  expect(tableCsv(table)).toBe("Derivative,Value\r\nCZ_alpha [1/rad],-4.6\r\ndelay,\r\n");
  expect(JSON.parse(tableJson(table))).toEqual({
    columns: ["Derivative", "Value"],
    data: [
      ["CZ_alpha [1/rad]", -4.6],
      ["delay", null],
    ],
  });
});

test("writes records with all digits, and objects within them by dotted names", () => {
  const rows = [
    { name: "CZ_alpha", value: -4.600000000000001, shares: { noise: 0.25 }, tests: [1, 2] },
    { name: "=1+1", value: null, shares: { noise: 0.5 }, suspect: true },
  ];
  expect(recordsCsv(rows)).toBe(
    "name,value,shares.noise,tests,suspect\r\n" +
      'CZ_alpha,-4.600000000000001,0.25,"[1,2]",\r\n' +
      "'=1+1,,0.5,,true\r\n",
  );
  expect(JSON.parse(recordsJson(rows))).toEqual(rows);
  expect(areRecords(rows)).toBe(true);
  expect(areRecords(["a"])).toBe(false);
  expect(areRecords([{ show: () => "a" }])).toBe(false);
});
