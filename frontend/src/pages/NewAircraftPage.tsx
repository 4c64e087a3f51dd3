import { Button, Group, Stack, Text, Textarea } from "@mantine/core";
import { Link, useNavigate } from "@tanstack/react-router";
import { useAddAircraft } from "../api/commands";
import { ButtonLink } from "../components/controls/ButtonLink";
import { PageHead } from "../components/frame/PageHead";
import { ProblemAlert } from "../components/display/ProblemAlert";
import { Section } from "../components/display/Section";
import { useDraft } from "../lib/drafts/useDraft";

const TEMPLATE = `[aircraft]
name = ""                          # of the aircraft and its campaign
pairs = ["symmetric"]              # wf1l and wf1r also make wf1s; az_tipl and az_tipr make az_tips

[aircraft.geometry]                # reference dimensions
area = { value = 0.0, unit = "m2" }
chord = { value = 0.0, unit = "m" }
span = { value = 0.0, unit = "m" }

[aircraft.mass]                    # against fuel fraction
fuel = [0.0, 1.0]
mass = { values = [0.0, 0.0], unit = "kg" }
pitch_inertia = { values = [0.0, 0.0], unit = "kg*m2" }
x_cg = { values = [0.0, 0.0], unit = "m" }

[[aircraft.surfaces]]              # repeat for every control surface
name = "elevator"

[[aircraft.sensors]]               # repeat for every sensor
name = "q"
kind = "gyro"                      # accelerometer, gyro, attitude, vane, strain
axis = "y"                         # of a gyro: the axis of rotation
location = { values = [0.0, 0.0, 0.0], unit = "m" }   # x aft, y right, z up
`;

/** Definition of an aircraft that has not flown yet. */
export function NewAircraftPage() {
  const add = useAddAircraft();
  const navigate = useNavigate();
  const { draft, setDraft, discard } = useDraft("new-aircraft", { text: TEMPLATE });
  return (
    <>
      <PageHead
        title="New aircraft"
        trail={[
          <Link to="/aircraft" className="link" key="aircraft">
            Aircraft
          </Link>,
        ]}
      />
      <Section
        title="Definition"
        note="Modal data, predictions and excitation can then be prepared before the first flight"
      >
        <form
          onSubmit={(event) => {
            event.preventDefault();
            add.mutate(draft.text, {
              onSuccess: (aircraft) => {
                discard();
                void navigate({ to: "/aircraft", search: { id: aircraft.id } });
              },
            });
          }}
        >
          <Stack gap="md" style={{ maxWidth: 860 }}>
            <Textarea
              label="TOML, as in a mapping"
              description="Every number has a unit of your choice. Coordinates are structural: x aft, y right, z up."
              autosize
              minRows={24}
              maxRows={40}
              spellCheck={false}
              styles={{ input: { fontFamily: "monospace" } }}
              value={draft.text}
              onChange={(event) => {
                setDraft({ text: event.currentTarget.value });
              }}
            />
            <Text size="xs" className="quiet">
              Further tables: instruments (filters and delays), combinations, polar, flutter,
              thrust. A recording of this aircraft names it in its mapping; its definition is not
              repeated there.
            </Text>
            {add.isError && <ProblemAlert error={add.error} />}
            <Group>
              <Button type="submit" loading={add.isPending}>
                Add aircraft
              </Button>
              <ButtonLink to="/aircraft" variant="default">
                Cancel
              </ButtonLink>
            </Group>
          </Stack>
        </form>
      </Section>
    </>
  );
}
