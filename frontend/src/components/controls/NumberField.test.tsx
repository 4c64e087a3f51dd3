import { screen } from "@testing-library/react";
import userEvent from "@testing-library/user-event";
import { useState } from "react";
import { afterEach, expect, it, vi } from "vitest";
import { show } from "../../test/render";
import { NumberField } from "./NumberField";

const FOOT = 0.3048;

/** Responds to requests of the page: display units are feet for metres. */
function serveFeet() {
  const respond = (address: string) =>
    address.includes("/units")
      ? { items: [{ unit: "m/s", display_unit: "ft/s", factor: 1 / FOOT }] }
      : { id: null, name: null };
  vi.spyOn(globalThis, "fetch").mockImplementation((request) =>
    Promise.resolve(
      Response.json(respond(request instanceof Request ? request.url : `${request}`)),
    ),
  );
}

afterEach(() => {
  vi.restoreAllMocks();
});

/** A field as pages use it: the parent holds numbers alone. */
function Field({ onChange, unit }: { onChange: (value?: number) => void; unit?: string }) {
  const [value, setValue] = useState<number>();
  return (
    <NumberField
      label="Value"
      unit={unit}
      value={value}
      onChange={(next) => {
        setValue(next);
        onChange(next);
      }}
    />
  );
}

it.each([
  ["0.05", 0.05],
  ["1.50", 1.5],
  ["-0.007", -0.007],
  ["10.0", 10],
  ["200", 200],
])("takes %s as it is typed", async (text, value) => {
  const onChange = vi.fn();
  await show(<Field onChange={onChange} />);
  const field = await screen.findByRole("textbox", { name: "Value" });
  await userEvent.type(field, text);
  expect(field).toHaveValue(text);
  expect(onChange).toHaveBeenLastCalledWith(value);
  await userEvent.tab();
  expect(field).toHaveValue(String(value));
});

it("gives nothing where nothing is left", async () => {
  const onChange = vi.fn();
  await show(<Field onChange={onChange} />);
  const field = await screen.findByRole("textbox", { name: "Value" });
  await userEvent.type(field, "3");
  await userEvent.clear(field);
  expect(onChange).toHaveBeenLastCalledWith(undefined);
});

it("shows and takes display units", async () => {
  serveFeet();
  const onChange = vi.fn();
  await show(<Field onChange={onChange} unit="m/s" />);
  const field = await screen.findByRole("textbox", { name: "Value [ft/s]" });
  await userEvent.type(field, "100.5");
  expect(onChange).toHaveBeenLastCalledWith(30.6324);
  await userEvent.tab();
  expect(field).toHaveValue("100.5");
});
