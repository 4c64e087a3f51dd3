import { axisNames } from "../../lib/derivatives";
import { NumberField } from "../controls/NumberField";
import { asAxis } from "../new-run/runRequest";
import { Button, Group, MultiSelect, Pill, Select, Stack, Text } from "@mantine/core";
import { useQueries, useQuery } from "@tanstack/react-query";
import { useRequestSearch } from "../../api/commands";
import { maneuverQuery, modalTablesQuery, searchesQuery, searchQuery } from "../../api/queries";
import { METHOD_NAMES, METHODS } from "../../api/types";
import { mayHaveSymmetry } from "../../lib/modes";
import { integer, integers, oneOf } from "../../lib/urlState";
import { SEARCH_ALGORITHMS, INITIAL_TERMS, type ModelStructuresView } from "../../views";
import { ManeuverSelect } from "../maneuvers/ManeuverSelect";
import { Empty } from "../display/Empty";
import { Loaded } from "../display/Loaded";
import { ProblemAlert } from "../display/ProblemAlert";
import { Section } from "../display/Section";
import { SearchResult } from "./SearchResult";

interface Props {
  view: ModelStructuresView;
  onChange: (change: Partial<ModelStructuresView>) => void;
}

/** Model structure determination: search for the terms of a model. */
export function StructureSearch({ view, onChange }: Props) {
  const search = useQuery({ ...searchQuery(view.id ?? 0), enabled: view.id !== undefined });
  return (
    <Section
      title="Structure search"
      note="Equation error selects the terms of each coefficient; output error and frequency response error fit whole models, remove terms by Wald’s test and add them by the score test."
    >
      <div className="split split-early">
        <SearchForm view={view} onChange={onChange} />
        {view.id === undefined ? (
          <Empty title="No search selected">
            Select maneuvers and modes and start a search, or open a previous one.
          </Empty>
        ) : (
          <Stack gap="md" miw={0}>
            <Loaded query={search} rows={8}>
              {(found) => (
                <SearchResult
                  search={found}
                  group={view.group}
                  onGroup={(group) => {
                    onChange({ group });
                  }}
                />
              )}
            </Loaded>
          </Stack>
        )}
      </div>
    </Section>
  );
}

const USUAL_F = 20;
const USUAL = { pse_noise: 25, resamplings: 30, max_iterations: 100, noise: "diagonal" } as const;

/** Form of a search: maneuvers, modes, method and thresholds. */
function SearchForm({ view, onChange }: Props) {
  const request = useRequestSearch();
  const earlier = useQuery(searchesQuery);
  const maneuvers = view.maneuvers ?? [];
  const first = useQuery({ ...maneuverQuery(maneuvers[0] ?? 0), enabled: maneuvers.length > 0 });
  const tables = useQuery({
    ...modalTablesQuery(first.data?.aircraft_id ?? 0),
    enabled: first.data !== undefined,
  });
  const table = tables.data?.find((one) => one.kind === "FEM") ?? tables.data?.[0];
  const axis = asAxis(first.data?.axis ?? "longitudinal");
  const isSymmetric = axisNames(axis).symmetry === "symmetric";
  const method = view.method ?? "EE";
  const start = () => {
    request.mutate(
      {
        maneuver_ids: maneuvers,
        method,
        structure: {
          modes: view.modes ?? [],
          inputs: [],
          outputs: [],
          free_delays: false,
          extra_parameters: [],
          axis,
          absent: [],
        },
        settings: {
          ...USUAL,
          algorithm: view.algorithm ?? "stepwise",
          initial_terms: view.initial_terms ?? "all",
          f_in: view.f_in ?? USUAL_F,
          f_out: view.f_out ?? view.f_in ?? USUAL_F,
          validate_on: view.unseen ?? [],
        },
      },
      {
        onSuccess: (search) => {
          onChange({ id: search.id, group: undefined });
        },
      },
    );
  };
  return (
    <form
      onSubmit={(event) => {
        event.preventDefault();
        start();
      }}
    >
      <Stack gap="md">
        <Select
          label="Previous searches"
          placeholder={earlier.data?.length === 0 ? "none yet" : "select"}
          clearable
          searchable
          data-testid="earlier-searches"
          data={(earlier.data ?? []).map((one) => ({
            value: String(one.id),
            label: `${String(one.id)}: ${one.sentence ?? `${one.method}, ${one.state}`}`,
          }))}
          value={view.id === undefined ? null : String(view.id)}
          onChange={(id) => {
            onChange({ id: integer(id), group: undefined });
          }}
        />
        <ManeuverTags
          label="Maneuvers"
          ids={maneuvers}
          onChange={(ids) => {
            onChange({ maneuvers: integers(ids) });
          }}
        />
        <MultiSelect
          label="Modes"
          description={maneuvers.length === 0 ? "Select a maneuver first" : table?.name}
          data={(table?.numbers ?? [])
            .map((number, index) => ({
              value: String(number),
              label: `${String(number)} ${table?.names[index] ?? ""}`,
              symmetric: table?.symmetric[index],
            }))
            .filter((mode) => mayHaveSymmetry(mode.symmetric, isSymmetric))}
          data-testid="search-modes"
          value={(view.modes ?? []).map(String)}
          onChange={(modes) => {
            onChange({ modes: integers(modes) });
          }}
        />
        <Select
          label="Method"
          allowDeselect={false}
          data={METHODS.map((one) => ({ value: one, label: `${one} ${METHOD_NAMES[one]}` }))}
          value={method}
          onChange={(value) => {
            onChange({ method: oneOf(value, METHODS) });
          }}
        />
        {method === "EE" ? (
          <Select
            label="Algorithm"
            allowDeselect={false}
            data={[...SEARCH_ALGORITHMS]}
            value={view.algorithm ?? "stepwise"}
            onChange={(value) => {
              onChange({ algorithm: oneOf(value, SEARCH_ALGORITHMS) });
            }}
          />
        ) : (
          <Select
            label="Start from"
            allowDeselect={false}
            data={[
              { value: "all", label: "all terms" },
              { value: "equation error", label: "terms selected by equation error" },
            ]}
            value={view.initial_terms ?? "all"}
            onChange={(value) => {
              onChange({ initial_terms: oneOf(value, INITIAL_TERMS) });
            }}
          />
        )}
        <Group grow align="end">
          <NumberField
            label="F to enter"
            min={0.1}
            value={view.f_in ?? USUAL_F}
            onChange={(value) => {
              onChange({ f_in: value });
            }}
          />
          <NumberField
            label="F to stay"
            min={0.1}
            value={view.f_out ?? view.f_in ?? USUAL_F}
            onChange={(value) => {
              onChange({ f_out: value });
            }}
          />
        </Group>
        <Text size="xs" className="quiet" mt={-8}>
          4 is 95 % for one term; 20, four and a half standard errors, leaves no chance term among a
          hundred.
        </Text>
        <ManeuverTags
          label="Validation maneuvers"
          ids={view.unseen ?? []}
          onChange={(ids) => {
            onChange({ unseen: integers(ids) });
          }}
        />
        <Button
          type="submit"
          loading={request.isPending}
          disabled={maneuvers.length === 0}
          data-testid="start-search"
        >
          Search
        </Button>
        {request.isError && <ProblemAlert error={request.error} />}
      </Stack>
    </form>
  );
}

interface ManeuverTagsProps {
  label: string;
  ids: number[];
  onChange: (ids: number[]) => void;
}

/** Maneuvers by their labels, one added at a time. */
function ManeuverTags({ label, ids, onChange }: ManeuverTagsProps) {
  const known = useQueries({ queries: ids.map((id) => maneuverQuery(id)) });
  return (
    <div>
      <Text size="sm" fw={500} mb={4}>
        {label}
      </Text>
      {ids.length > 0 && (
        <Pill.Group mb={6}>
          {ids.map((id, index) => (
            <Pill
              key={id}
              withRemoveButton
              removeButtonProps={{ "aria-label": `Remove maneuver ${String(id)}` }}
              onRemove={() => {
                onChange(ids.filter((one) => one !== id));
              }}
            >
              {known[index]?.data?.label ?? `maneuver ${String(id)}`}
            </Pill>
          ))}
        </Pill.Group>
      )}
      <ManeuverSelect
        label={label}
        placeholder="Add a maneuver"
        onChoose={(id) => {
          if (!ids.includes(id)) onChange([...ids, id]);
        }}
      />
    </div>
  );
}
