import { useQuery } from "@tanstack/react-query";
import { Link } from "@tanstack/react-router";
import { conditionsQuery } from "../api/queries";
import type { ConditionItem } from "../api/types";
import { DataTable, numeric, type Column } from "../components/controls/DataTable";
import { Loaded } from "../components/display/Loaded";
import { quantity } from "../components/display/Quantity";
import { PageHead } from "../components/frame/PageHead";
import { fixed, percent } from "../lib/text/format";

const COLUMNS: Column<ConditionItem>[] = [
  {
    key: "name",
    header: "Condition",
    render: (one) => (
      <Link to="/conditions/$id" params={{ id: one.id }} className="link">
        {conditionName(one)}
      </Link>
    ),
  },
  { key: "axis", header: "Axis", render: (one) => one.axis },
  quantity("airspeed", "Airspeed", (one) => one.airspeed_m_s, "m/s", 1),
  quantity("pressure", "Dynamic pressure", (one) => one.dynamic_pressure_pa, "Pa", 0),
  {
    key: "records",
    header: "Records",
    wraps: true,
    render: (one) => one.records.map((record) => record.label).join(", "),
  },
  numeric("runs", "Runs", (one) => one.n_runs),
];

/** Aircraft, airspeed and fuel of a condition. */
export function conditionName(one: ConditionItem, fuel = one.fuel_fraction): string {
  const ratio = one.airspeed_ratio === null ? "" : ` · ${fixed(one.airspeed_ratio, 2)} Vf`;
  return `${one.aircraft_name}${ratio} · fuel ${percent(fuel)} %`;
}

/** Flight conditions: maneuvers of one aircraft and axis at one airspeed and fuel. */
export function ConditionsPage() {
  const conditions = useQuery(conditionsQuery());
  return (
    <>
      <PageHead title="Conditions" />
      <Loaded query={conditions} rows={8}>
        {(items) => (
          <div className="panel">
            <DataTable
              label="Flight conditions"
              columns={COLUMNS}
              rows={items}
              rowKey={(one) => one.id}
            />
          </div>
        )}
      </Loaded>
    </>
  );
}
