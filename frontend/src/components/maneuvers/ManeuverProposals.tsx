import { Button, Group, Text } from "@mantine/core";
import { Link } from "@tanstack/react-router";
import { useCut } from "../../api/commands";
import type { ManeuverProposal } from "../../api/types";
import { fixed } from "../../lib/text/format";
import { DataTable, type Column } from "../controls/DataTable";
import { ProblemAlert } from "../display/ProblemAlert";

interface Props {
  flightId: number;
  items: ManeuverProposal[];
  onLook: (one: ManeuverProposal) => void;
}

/** Detected maneuvers, each to be shown or cut. */
export function ManeuverProposals({ flightId, items, onLook }: Props) {
  const cut = useCut(flightId);
  if (items.length === 0) {
    return (
      <Text size="sm" className="quiet">
        No maneuver detected; select a window in the recording below.
      </Text>
    );
  }
  const left = items.filter((one) => one.maneuver_id === null);
  const columns: Column<ManeuverProposal>[] = [
    { key: "label", header: "Maneuver", render: (one) => one.label },
    {
      key: "window",
      header: "Window",
      unit: "s",
      numeric: true,
      render: (one) => `${fixed(one.start_s, 2)} to ${fixed(one.stop_s, 2)}`,
    },
    { key: "periods", header: "Periods", numeric: true, render: (one) => one.n_periods },
    {
      key: "excitation",
      header: "Excitation",
      wraps: true,
      render: (one) =>
        one.excitation === null ? "no multisine identified" : describeExcitation(one),
    },
    { key: "basis", header: "Detected by", render: (one) => one.basis },
    {
      key: "act",
      header: "",
      render: (one) =>
        one.maneuver_id !== null ? (
          <Link to="/maneuvers/$id" params={{ id: one.maneuver_id }} className="link">
            cut already
          </Link>
        ) : (
          <Group gap={4} wrap="nowrap">
            <Button
              size="compact-xs"
              variant="subtle"
              onClick={() => {
                onLook(one);
              }}
            >
              {" "}
              Show{" "}
            </Button>
            <Button
              size="compact-xs"
              variant="default"
              loading={cut.isPending}
              data-testid={`cut-${one.label}`}
              onClick={() => {
                cut.mutate([cutRequest(one)]);
              }}
            >
              Cut
            </Button>
          </Group>
        ),
    },
  ];
  return (
    <>
      {cut.isError && <ProblemAlert error={cut.error} />}
      <DataTable
        label="Detected maneuvers"
        testId="maneuver-proposals"
        columns={columns}
        rows={items}
        rowKey={(one) => one.start_s}
        maxHeight={320}
      />
      {left.length > 1 && (
        <Button
          mt="sm"
          loading={cut.isPending}
          data-testid="cut-all"
          onClick={() => {
            cut.mutate(left.map(cutRequest));
          }}
        >
          Cut all {left.length}
        </Button>
      )}
    </>
  );
}

const cutRequest = (one: ManeuverProposal) => ({
  label: one.label,
  start_s: one.start_s,
  stop_s: one.stop_s,
  fta: one.fta,
  axis: null,
  note: "",
});

function describeExcitation({ excitation }: ManeuverProposal): string {
  if (excitation === null) return "";
  const counts = Object.entries(excitation.harmonics).map(([name, all]) => `${name} ${all.length}`);
  return `T = ${fixed(excitation.period_s, 2)} s, harmonics ${counts.join(", ")}`;
}
