import type { LiveEstimate } from "../../api/types";
import { percent } from "../../lib/text/format";
import { Quantity, UnitName } from "../display/Quantity";
import { Section } from "../display/Section";

interface Props {
  estimate: LiveEstimate | null;
  /** Airspeed of the next test point; null if none is planned. [m/s] */
  next_m_s: number | null;
}

/** Predicted flutter speed and the margin of the next test point, in large digits. */
export function FlutterMargin({ estimate, next_m_s }: Props) {
  const flutter = estimate?.flutter_m_s ?? null;
  const std = estimate?.flutter_std_m_s ?? null;
  const condition = estimate?.condition ?? null;
  const margin = flutter === null || next_m_s === null ? null : flutter / next_m_s - 1;
  return (
    <Section title="Flutter" note="Predicted from this maneuver, ± 2 standard errors">
      <dl className="live-facts" data-testid="flutter-margin">
        <div>
          <dt>
            Flutter speed <Airspeed />
          </dt>
          <dd className="live-digits">
            {flutter === null ? (
              estimate === null ? (
                "–"
              ) : (
                "none predicted"
              )
            ) : (
              <>
                <Quantity value={flutter} unit="m/s" decimals={1} />
                <span className="live-interval">
                  {" "}
                  ±{" "}
                  {std === null ? "unknown" : <Quantity value={2 * std} unit="m/s" decimals={1} />}
                </span>
              </>
            )}
          </dd>
        </div>
        {condition !== null && (
          <div data-testid="live-condition">
            <dt>
              Present airspeed <Airspeed />
            </dt>
            <dd className="live-digits">
              <Quantity value={condition.airspeed_m_s} unit="m/s" decimals={1} />
            </dd>
            <dd className={condition.is_measured ? "quiet" : "live-assumed"}>
              <Quantity value={condition.density_kg_m3} unit="kg/m3" decimals={3} named />, fuel{" "}
              {percent(condition.fuel_fraction, 0)} %
              {condition.is_measured
                ? ", measured"
                : ": NOT MEASURED, assumed as in the run of the stream"}
            </dd>
          </div>
        )}
        <div>
          <dt>
            Next test point <Airspeed />
          </dt>
          <dd className="live-digits">
            {next_m_s === null ? "none" : <Quantity value={next_m_s} unit="m/s" decimals={1} />}
          </dd>
        </div>
        {next_m_s !== null && (
          <>
            <div>
              <dt>
                Margin <span className="unit">[% of the next airspeed]</span>
              </dt>
              <dd className="live-digits" data-negative={margin !== null && margin < 0}>
                {percent(margin, 1)}
                {margin !== null && std !== null && (
                  <span className="live-interval"> ± {percent((2 * std) / next_m_s, 1)}</span>
                )}
              </dd>
            </div>
            <div>
              <dt>
                Flutter below the next test point <span className="unit">[% probability]</span>
              </dt>
              <dd className="live-digits">{percent(estimate?.next_point_probability, 1)}</dd>
            </div>
          </>
        )}
      </dl>
    </Section>
  );
}

const Airspeed = () => (
  <span className="unit">
    [<UnitName unit="m/s" />]
  </span>
);
