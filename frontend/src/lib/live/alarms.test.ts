import { expect, it } from "vitest";
import { addAlarms, splitAlarms } from "./alarms";

const alarm = (subject: string, time_s: number) => ({ kind: "unstable", subject, time_s });

it("leaves an alarm open until it is acknowledged, also when it is raised again", () => {
  const alarms = [alarm("SW1B", 8), alarm("SW2B", 9), alarm("SW1B", 40)];
  const { open, acknowledged } = splitAlarms(alarms, [{ ...alarm("SW1B", 8), author: "Ann" }]);
  expect(open).toEqual([alarm("SW2B", 9), alarm("SW1B", 40)]);
  expect(acknowledged).toEqual([{ ...alarm("SW1B", 8), author: "Ann" }]);
});

it("has every alarm once, and those of an earlier maneuver", () => {
  const known = addAlarms([alarm("SW1B", 8)], [alarm("SW1B", 8), alarm("SW2B", 40)]);
  expect(known).toEqual([alarm("SW1B", 8), alarm("SW2B", 40)]);
  expect(addAlarms(known, [alarm("SW2B", 40)])).toBe(known);
});
