import { useQuery } from "@tanstack/react-query";
import { getRouteApi } from "@tanstack/react-router";
import { glossaryQuery } from "../api/queries";
import { useDisplayUnits } from "../api/units";
import type { GlossaryEntry } from "../api/types";
import { DataTable, type Column } from "../components/controls/DataTable";
import { Empty } from "../components/display/Empty";
import { FilterInput } from "../components/controls/FilterInput";
import { SearchIcon } from "../components/display/icons";
import { Loaded } from "../components/display/Loaded";
import { PageHead } from "../components/frame/PageHead";

const route = getRouteApi("/glossary");

const columns: Column<GlossaryEntry>[] = [
  { key: "symbol", header: "Symbol", render: (one) => <code>{one.symbol}</code> },
  { key: "label", header: "In tables", render: (one) => <Subscripts text={one.label} /> },
  { key: "unit", header: "Unit stored", render: (one) => one.unit },
  { key: "display_unit", header: "Unit shown", render: (one) => one.display_unit },
  { key: "meaning", header: "Meaning", wraps: true, render: (one) => one.meaning },
];

/** `V_f` with its index below the line. */
function Subscripts({ text }: { text: string }) {
  return text
    .split(/_(\w+)/)
    .map((part, place) => (place % 2 === 1 ? <sub key={place}>{part}</sub> : part));
}

/** What every symbol of the workbench stands for, with its unit. */
export function GlossaryPage() {
  const { search = "" } = route.useSearch();
  const navigate = route.useNavigate();
  const glossary = useQuery(glossaryQuery(useDisplayUnits()));
  const query = search.toLowerCase();
  return (
    <>
      <PageHead
        title="Glossary"
        actions={
          <FilterInput
            aria-label="Search the glossary"
            placeholder="Symbol or meaning"
            w={220}
            leftSection={<SearchIcon size={12} />}
            data-testid="filter-search"
            value={search}
            onCommit={(text) =>
              void navigate({ search: { search: text === "" ? undefined : text }, replace: true })
            }
          />
        }
      />
      <div className="panel">
        <Loaded query={glossary} rows={12}>
          {(entries) => {
            const shown = entries.filter((one) =>
              `${one.symbol} ${one.meaning} ${one.unit}`.toLowerCase().includes(query),
            );
            return shown.length === 0 ? (
              <Empty title="No such symbol">Clear the search to see all of them.</Empty>
            ) : (
              <DataTable
                label="Glossary"
                testId="glossary-table"
                columns={columns}
                rows={shown}
                rowKey={(one) => one.symbol}
              />
            );
          }}
        </Loaded>
      </div>
    </>
  );
}
