import { useQuery } from "@tanstack/react-query";
import { Link } from "@tanstack/react-router";
import { aircraftQuery, repeatedLevelsQuery } from "../../api/queries";
import type { RepeatedLevels } from "../../api/types";
import { significant } from "../../lib/text/format";
import type { CampaignView } from "../../views";
import { DataTable, numeric, type Column } from "../controls/DataTable";
import { Empty } from "../display/Empty";
import { Loaded } from "../display/Loaded";
import { quantity } from "../display/Quantity";

const degrees = (rad: number) => significant((180 / Math.PI) * rad, 3);

const COLUMNS: Column<RepeatedLevels>[] = [
  { key: "label", header: "Maneuver", render: (one) => one.label },
  quantity("airspeed", "True airspeed", (one) => one.airspeed_m_s, "m/s", 1),
  numeric(
    "levels",
    "Amplitudes",
    (one) => one.levels.map((level) => degrees(level.amplitude_rad)).join(", "),
    "deg rms",
  ),
  {
    key: "verdict",
    header: "One linear model",
    wraps: true,
    render: (one) => <Verdict levels={one} />,
  },
];

/** Maneuvers of the campaign that were repeated at other amplitudes, and whether they are linear. */
export function CampaignAmplitudes({ view }: { view: CampaignView }) {
  const aircraft = useQuery(aircraftQuery);
  const id = view.aircraft ?? aircraft.data?.[0]?.id;
  const levels = useQuery({ ...repeatedLevelsQuery(id ?? 0), enabled: id !== undefined });
  if (aircraft.data?.length === 0) return null;
  return (
    <Loaded query={levels} rows={3}>
      {(found) =>
        found.length === 0 ? (
          <Empty title="No repeated amplitudes">
            Fly one multisine at another amplitude at the same condition, e.g. FTA 506 and 507.
          </Empty>
        ) : (
          <div className="panel">
            <DataTable
              label="Maneuvers at several amplitudes"
              testId="repeated-levels"
              columns={COLUMNS}
              rows={found}
              rowKey={(one) => one.levels.map((level) => level.label).join()}
            />
          </div>
        )
      }
    </Loaded>
  );
}

function Verdict({ levels }: { levels: RepeatedLevels }) {
  const runs = levels.levels.flatMap((level) => level.run_ids);
  if (levels.levels.filter((level) => level.run_ids.length > 0).length < 2) {
    return <>Needs output-error runs of two levels with one model structure</>;
  }
  return (
    <Link
      to="/compare"
      search={{ tab: "trends", runs, amplitudes: true }}
      hash="amplitudes"
      className="link"
    >
      {levels.comparison === null ? "Compare amplitudes" : levels.comparison.sentence}
    </Link>
  );
}
