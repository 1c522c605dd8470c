{{%AUTOESCAPE context="HTML"}}
<svg class="calibrations" viewBox="0 0 {{WIDTH}} {{HEIGHT}}" width="{{WIDTH}}" height="{{HEIGHT}}" role="img" aria-label="{{LABEL}}"><path class="ages" d="{{AGES}}"/><path class="limit" d="M{{LEFT}} {{OFF}}H{{RIGHT}}M{{LEFT}} {{AGE_LIMIT}}H{{RIGHT}}"/>{{#DOTS}}<path class="{{LEVEL}}" d="{{D}}"/>{{/DOTS}}</svg>
