{{%AUTOESCAPE context="HTML"}}
<svg class="map picture" viewBox="0 0 360 {{MAP_HEIGHT}}" role="img" aria-label="{{LABEL}}">
<svg x="0" y="0" width="360" height="{{MAP_HEIGHT}}" viewBox="0 0 {{COLUMNS}} {{ROWS}}" preserveAspectRatio="none">
{{#HEAT}}<path class="heat{{LEVEL}}" d="{{D}}"/>{{/HEAT}}
{{#UNSEEN}}<path class="unseen under" d="{{D}}"/><path class="unseen" d="{{D}}"/>{{/UNSEEN}}
</svg>
{{#ARROWS}}<path class="shift" d="{{D}}"/>{{/ARROWS}}
</svg>
<p class="legend small">px: {{#KEY}}<span class="key heat{{LEVEL}}">{{TEXT}}</span>{{/KEY}}{{#UNSEEN}}<span class="key unseen">no corners there</span>{{/UNSEEN}}{{#ARROWS}}<span class="key shift">which way, {{MAGNIFIED}} times as long</span>{{/ARROWS}}{{#BLANK}}<span>blank: no ray of the lens leads there</span>{{/BLANK}}</p>
